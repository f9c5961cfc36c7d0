// Facts about a recording as a whole: duration, components, ports, sensors, states and logs. Read once, when it is opened. Values; any
// thread.
#pragma once

#include <chrono>
#include <map>
#include <string>

#include "base/result.h"
#include "recording/mcap/mcap.h"
#include "studio/client_message.h"
#include "system/profile/rts_profile.h"

namespace studio {

struct RecordingFacts {
  std::string file;  // as it was named
  // Of log times; `zero` is taken off all times that a viewer is told: of a recording by the wall clock its begin, else nothing.
  std::chrono::nanoseconds from{0}, to{0}, zero{0};
  std::string world;                                     // its name; empty: there was none
  std::string damage;                                    // what of the file could not be read; empty: nothing
  Json components = Json::array();                       // as in the event "system"
  Json connections = Json::array();                      //
  Json signals = Json::array();                          // as in the event "signals"
  Json ifaces = Json::array();                           // as in the event "world"
  Json states = Json::object();                          // by path of the component: [[time [s], state], ...]
  Json lines = Json::array();                            // of logs: [time [s], level, component, text]
  std::uint64_t lines_left_out = 0;                      // behind those
  std::map<std::string, tools::SavedComponent> saved{};  // by path: what the profile says of them

  static base::Result<RecordingFacts> read(const std::string& file);
  double seconds(std::chrono::nanoseconds time) const { return std::chrono::duration<double>(time - zero).count(); }
  std::chrono::nanoseconds time_of(double seconds) const;
  // "from 2 to 2.5 s: ..."
  std::string text_of(const mcap::Reader::BrokenChunk& chunk) const;
};

// The file begins as recordings do.
bool is_recording(const std::string& file);

std::chrono::nanoseconds to_nanoseconds(mcap::Time time);
mcap::Time to_mcap_time(std::chrono::nanoseconds time);

// The topic of an iface, as its channels begin: "laser", "robot::laser" -> "/sim/laser/robot/laser".
std::string iface_topic(const std::string& type, const std::string& name);

}  // namespace studio

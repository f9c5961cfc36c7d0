// What components of others send each other in a run. It passes no port of ours, so each such OutPort is listened to, as a recorder does:
// for the hash log, where its samples stand as those of an OutPort of ours, and for what depends on chance. A stamp of the sender's own
// clock, which differs in each run, is left out: where the first member of the type is an RTC::Time, it counts as 0.
//
// A sample belongs to the simulated time in which it comes: its sender waits for the listener, and in lock step time waits for the sender.
// One thread at a time; samples come on the ORB's threads, and end() returns when none is under way any more.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "base/hash_log.h"
#include "editor.h"
#include "profile/rts_profile.h"
#include "run/chance_report.h"
#include "run/foreign_processes.h"
#include "shm/client.h"
#include "tap.h"

namespace editor {

class ForeignLinks {
 public:
  // `log`: where the part of the hash log goes; empty: nowhere. To be called while time stands still. What cannot be listened to is named,
  // for the user: it is no reason to end a run.
  Result<std::vector<std::string>> listen(CORBA::ORB_ptr orb, const Editor& editor, const SavedSystem& system,
                                          const ForeignProcesses& foreign, const std::string& simulator, const std::string& log);
  // Samples that came while no phase ran. One line for each port.
  std::vector<std::string> chances(const PlacesInTime& places) const;
  // Listens no more; the log is whole then.
  void end();

 private:
  struct Port {
    std::string name;  // "Alien:out"
    std::uint32_t key = 0;
    bool has_stamp = false;
    std::uint64_t samples = 0;                                // in this tick
    std::uint64_t hash = 0;                                   // of these
    std::string value;                                        // of the last one
    std::optional<std::chrono::nanoseconds> between_ticks{};  // the first that came so
  };
  struct Data {
    std::optional<shm::Iface> simulation;
    std::optional<base::HashLogWriter> log;
    std::uint32_t resets = 0;
    std::chrono::nanoseconds time{0};  // of the samples that are not in the log yet
    std::vector<Port> ports;
  };
  Result<void> listen_on(CORBA::ORB_ptr orb, const Editor& editor, const ForeignProcesses& foreign, const std::string& name);
  static void write(Data& data);
  void take(std::size_t port, std::span<const unsigned char> payload, bool is_little_endian);

  base::Guarded<Data, base::Rank::buffer> data_;
  std::vector<std::unique_ptr<Tap>> taps_;
};

}  // namespace editor

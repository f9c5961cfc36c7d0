// Logs, states, configuration and events of components, as channels:
//
//   /log                           rcl_interfaces/msg/Log     lines of their logs, from level info on
//   /rtc/COMPONENT/state           json: context, state, is_in_tick    as it is at first, then whenever it changes
//   /rtc/COMPONENT/configuration   json: set, values, is_change        all of the active set at first, then what takes effect
//   /rtc/COMPONENT/events          json: kind, event                   contexts, profiles, configuration sets
//   /diagnostics                   diagnostic_msgs/msg/DiagnosticArray, when diagnose() is called
//
// Components of rtm-sim send the time of each event, so the times are those of the ticks, also if a message is late. Third-party components
// are only polled (at first, and by diagnose()). A component costs nothing while nothing happens. Construct, use and destroy on one
// thread, but for diagnose().
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/result.h"
#include "channels/exchange.h"
#include "recording/port_source.h"
#include "system/component_view.h"

namespace recorder {

struct ComponentEvent {
  std::chrono::nanoseconds time{0};
  std::string kind;   // "RTC_STATUS", ...
  std::string event;  // "ACTIVE:0"
  bool is_in_tick = false;
};

class ComponentSource final {
 public:
  // The exchange, the clock and the ports must live longer.
  ComponentSource(CORBA::ORB_ptr orb, channels::Exchange& exchange, const base::Clock& clock);
  ~ComponentSource();  // takes what they still have to say

  // Called for each event, on the ORB's threads; before add().
  void on_event(std::function<void(const std::string& component, const ComponentEvent&)> told);
  // Seen with contexts and configuration. Fails when there are too many channels.
  base::Result<void> add(const tools::ComponentView& component);
  // The channels of a component that was started again go on with the new one. Nothing happens to others.
  void attach_again(const tools::ComponentView& component);
  // States and rates at this moment, on any one thread. Asks each component, for at most the call limit of the thread.
  void diagnose(channels::Time now, const PortSource& ports);
  std::size_t size() const;

 private:
  class Watched;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace recorder

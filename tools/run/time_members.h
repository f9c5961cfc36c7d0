// Components of other processes in simulated time, by the standard calls only: each gets a proxy in one of our hosts (SimTimeProxy), whose
// SimTimeContext it becomes a member of. What it asks of such a component is in docs/third-party-components.md. One thread at a time.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "base/child_process.h"
#include "system/session.h"

namespace tools {

inline constexpr int highest_phase = 15, highest_turn = 9999;
inline constexpr const char* turn_key = "exec_cxt.sim_time.turn";

struct TimeMember {
  // member: the context of its proxy calls it. tick: the proxy ticks the component's own context, one that is ticked from outside. clock:
  // that context subscribes itself to the ClockGenerator, so nothing is done but to wait for it.
  enum class How { member, tick, clock };
  std::string instance;
  int phase = 1;
  std::string rate{};  // [Hz]; of simulated time
  How how = How::member;
  int turn = 0;  // within the phase (call_order.h)
};
std::optional<TimeMember::How> parse_how(const std::string& text);

// The instance name of the proxy of a component.
std::string proxy_name(const std::string& instance);
// It is there, and answers.
bool has_proxy(const Session& session, const std::string& instance);
// What a manager makes it from.
std::string proxy_creation(const TimeMember& member, const std::string& server_id);

// The same for the component that is OpenHRP's clock.
std::string clock_creation(int phase, const std::string& server_id);

// The words and environment of an rtcd whose components are on simulated time and come from `creations`. `empty_file`: a configuration file
// with nothing in it, so that no other is read.
struct HostSettings {
  std::string naming;                       // HOST:PORT
  std::string name;                         // manager.instance_name
  std::vector<std::string> module_paths{};  // before our own
  std::string empty_file;
  std::vector<std::string> options{};  // "key:value", further ones
  std::vector<std::string> creations{};
};
std::vector<std::string> host_words(const HostSettings& settings);
// Those of the user, then our own.
std::vector<std::string> module_paths(const std::vector<std::string>& before);

// The context on simulated time in which a component of another process takes part; nullptr when there is none.
const ContextView* simulated_context(const ComponentView& component);

// Its own context is one that runs it after tick(), not in it.
bool ticks_on_its_own(const ComponentView& component);

// Brings a component into the context of its proxy. Where it was active in contexts of its own it is deactivated there and activated here;
// these contexts run on. With `tick` its own first context is ticked instead, and its state there stays. A component that takes part
// already, or is in its error state, is rejected. `timeout`: with its attach_context.
Result<void> join_time(const Session& session, const std::string& component, const std::string& proxy, TimeMember::How how,
                       std::chrono::milliseconds timeout);
// Deactivates it where it takes part; nothing if it is not active there. A context that is ticked gets one tick for it if need be: in that
// the component is not executed any more.
Result<void> rest_in_time(const Session& session, const std::string& component, TimeMember::How how);
// Undoes it: active here becomes active in its own first context. The proxy ends.
Result<void> leave_time(const Session& session, const std::string& component);

}  // namespace tools

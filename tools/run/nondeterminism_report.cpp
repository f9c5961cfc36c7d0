#include "run/nondeterminism_report.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <utility>

#include "base/nondeterminism.h"
#include "base/text.h"
#include "run/run_files.h"
#include "run/run_system.h"
#include "run/simulator.h"
#include "system/component_view.h"
#include "system/profile/rts_profile.h"

namespace tools {
namespace {

// The component that a line is about: "port My Arm:out was ..." is about My Arm, "component Arm had ..." about Arm.
const ScheduleSlot* place_of(const std::string& what, const Schedule& places) {
  const Schedule::value_type* longest = nullptr;
  for (const auto& one : places) {
    const bool fits = what.starts_with("port " + one.first + ":") || what.starts_with("component " + one.first + " ");
    if (fits && (!longest || one.first.size() > longest->first.size())) longest = &one;
  }
  return longest ? &longest->second : nullptr;
}

// "port A:out ... at 0.06 s" of a component that is called each 10 ms: ", in tick 6". What came between two ticks counts as of the first.
std::string tick_text(const std::string& what, const Schedule& places) {
  const auto words = base::split_list(what, ' ');
  if (words.size() < 4 || words.back() != "s") return "";
  const auto* place = place_of(what, places);
  const auto time = base::parse_number(words[words.size() - 2]);
  if (!place || place->period.count() <= 0 || !time) return "";
  return ", in tick " + std::to_string(std::llround(*time * 1e9) / place->period.count());
}

// As services of that kind and their users set it.
bool is_ci_job() {
  const char* value = std::getenv("CI");
  return value != nullptr && *value != '\0' && std::string_view(value) != "false" && std::string_view(value) != "0";
}

}  // namespace

Schedule read_schedule(Simulator& simulator) {
  const std::chrono::nanoseconds step(std::llround(simulator.step() * 1e9));
  Schedule places;
  for (const auto& one : simulator.participants()) places[one.name] = {one.phase, std::max(one.period, step)};
  return places;
}

bool reports_nondeterminism(const RunOptions& options) { return options.strict || is_ci_job(); }

std::string with_tick(const std::string& what, const Schedule& places) { return what + tick_text(what, places); }

std::vector<std::string> nondeterministic_events_in(const std::vector<std::string>& logs, const Schedule& places) {
  std::vector<std::string> found;
  for (const auto& log : logs) {
    for (const auto& line : lines_of(log)) {
      const auto at = line.find(base::nondeterminism_mark);
      if (at == std::string::npos) continue;
      auto what = with_tick(line.substr(at + base::nondeterminism_mark.size()), places);
      if (std::ranges::find(found, what) == found.end()) found.push_back(std::move(what));
    }
  }
  return found;
}

std::vector<std::string> services_of_one_phase(const SavedSystem& system, const Schedule& places) {
  std::vector<std::string> found;
  for (const auto& connector : system.connectors) {
    if (connector.is_data || connector.source.instance == connector.target.instance) continue;
    const auto source = places.find(connector.source.instance), target = places.find(connector.target.instance);
    if (source == places.end() || target == places.end() || source->second.phase != target->second.phase) continue;
    found.push_back("a service between " + connector.source.port_name + " and " + connector.target.port_name + ", both of phase " +
                    std::to_string(source->second.phase) + ": give them different phases");
  }
  return found;
}

std::set<std::string> providers_of(const ComponentView& component) {
  std::set<std::string> ports;
  for (const PortView& port : component.ports) {
    if (std::ranges::any_of(port.interfaces, &InterfaceView::is_provided)) ports.insert(port.full_name);
  }
  return ports;
}

std::vector<std::string> callers_of_one_phase(const SavedSystem& system, const Schedule& places, const std::set<std::string>& providers) {
  struct Caller {
    const SavedTarget *from, *to;
    std::int64_t phase;
  };
  std::vector<Caller> callers;
  std::vector<std::string> found;
  const auto take = [&](const SavedTarget& from, const SavedTarget& to) {
    const auto phase = places.find(from.instance);
    if (phase == places.end() || from.instance == to.instance || !providers.contains(to.port_name)) return;
    const Caller caller{&from, &to, phase->second.phase};
    for (const Caller& other : callers) {
      if (other.phase != caller.phase || other.to->instance != to.instance || other.from->instance == from.instance) continue;
      const auto also = other.to->port_name == to.port_name ? std::string() : " and " + to.port_name;
      found.push_back("calls from " + other.from->port_name + " and " + from.port_name + ", both of phase " + std::to_string(caller.phase) +
                      ", to " + other.to->port_name + also + ": give them different phases");
    }
    callers.push_back(caller);
  };
  for (const auto& connector : system.connectors) {
    if (connector.is_data) continue;
    take(connector.source, connector.target);
    take(connector.target, connector.source);
  }
  return found;
}

}  // namespace tools

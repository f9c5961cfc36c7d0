#include "run/chance_report.h"

#include <algorithm>
#include <utility>

#include "base/chance.h"
#include "component_view.h"
#include "profile/rts_profile.h"
#include "run/run_files.h"

namespace editor {

std::vector<std::string> chances_in(const std::vector<std::string>& logs) {
  std::vector<std::string> found;
  for (const auto& log : logs) {
    for (const auto& line : lines_of(log)) {
      const auto at = line.find(base::chance_mark);
      if (at == std::string::npos) continue;
      auto what = line.substr(at + base::chance_mark.size());
      if (std::ranges::find(found, what) == found.end()) found.push_back(std::move(what));
    }
  }
  return found;
}

std::vector<std::string> services_of_one_phase(const SavedSystem& system, const std::map<std::string, std::int64_t>& phases) {
  std::vector<std::string> found;
  for (const auto& connector : system.connectors) {
    if (connector.is_data || connector.source.instance == connector.target.instance) continue;
    const auto source = phases.find(connector.source.instance), target = phases.find(connector.target.instance);
    if (source == phases.end() || target == phases.end() || source->second != target->second) continue;
    found.push_back("a service between " + connector.source.port_name + " and " + connector.target.port_name + ", both of phase " +
                    std::to_string(source->second) + ": give them different phases");
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

std::vector<std::string> callers_of_one_phase(const SavedSystem& system, const std::map<std::string, std::int64_t>& phases,
                                              const std::set<std::string>& providers) {
  struct Caller {
    const SavedTarget *from, *to;
    std::int64_t phase;
  };
  std::vector<Caller> callers;
  std::vector<std::string> found;
  const auto take = [&](const SavedTarget& from, const SavedTarget& to) {
    const auto phase = phases.find(from.instance);
    if (phase == phases.end() || from.instance == to.instance || !providers.contains(to.port_name)) return;
    const Caller caller{&from, &to, phase->second};
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

}  // namespace editor

#include "run/chance_report.h"

#include <algorithm>

#include "base/chance.h"
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

}  // namespace editor

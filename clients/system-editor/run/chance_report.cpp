#include "run/chance_report.h"

#include <algorithm>

#include "base/chance.h"
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

}  // namespace editor

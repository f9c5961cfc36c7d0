#include "served.h"

#include <algorithm>
#include <vector>

#include "base/text.h"

namespace gateway {

bool is_served(ServedTable table, std::uint32_t type, std::uint32_t subtype) {
  return std::any_of(table.begin(), table.end(),
                     [&](const Served& one) { return static_cast<std::uint32_t>(one.type) == type && one.subtype == subtype; });
}

std::string describe(ServedTable table, player::Type type) {
  std::vector<std::string> parts;
  for (const Served& one : table) {
    if (one.type == type && !one.what.empty()) parts.emplace_back(one.what);
  }
  return base::join(parts, "; ");
}

}  // namespace gateway

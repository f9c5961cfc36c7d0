#include "shm/fault_kinds.h"

#include <cmath>
#include <vector>

#include "base/text.h"

namespace shm {
namespace {

// row_of() finds a kind by its place.
constexpr bool is_in_order() {
  for (std::size_t i = 0; i < fault_rows.size(); ++i) {
    if (fault_rows[i].kind != static_cast<FaultKind>(i)) return false;
  }
  return true;
}
static_assert(is_in_order());

}  // namespace

std::string fault_names() {
  std::vector<std::string> names;
  for (const FaultRow& row : fault_rows) names.emplace_back(row.name);
  return base::join(names, ", ");
}

base::Result<const FaultRow*> check_fault(std::string_view name, std::optional<double> amount) {
  const FaultRow* row = find_fault(name);
  if (row == nullptr)
    return base::Error{"fault " + base::in_quotes(std::string(name)) + ": unknown fault; expected one of " + fault_names()};
  if (!row->amount || !amount) return row;
  if (row->kind == FaultKind::latency && *amount != std::floor(*amount))
    return base::Error{"fault " + std::string(name) + ": its amount must be a whole number of samples, got " +
                       base::format_number(*amount)};
  if (*amount >= row->min_amount && *amount <= row->max_amount) return row;
  return base::Error{"fault " + std::string(name) + ": its amount must be from " + base::format_number(row->min_amount) + " to " +
                     base::format_number(row->max_amount) + ", got " + base::format_number(*amount)};
}

}  // namespace shm

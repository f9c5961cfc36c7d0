#include "line_limit.h"

#include <algorithm>
#include <utility>

namespace iface {

std::optional<std::string> LineLimit::next(const std::string& line, std::chrono::steady_clock::time_point now) {
  constexpr std::chrono::seconds worth(1), most(8);
  const auto paid = std::max(paid_until_, now) + worth;
  if (paid > now + most) {
    ++left_out_;
    return std::nullopt;
  }
  paid_until_ = paid;
  const auto count = std::exchange(left_out_, 0);
  return count == 0 ? line : line + " (" + std::to_string(count) + " more lines like this are not in the log)";
}

}  // namespace iface

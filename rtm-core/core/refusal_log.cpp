#include "core/refusal_log.h"

#include <algorithm>
#include <utility>

namespace rt {

std::optional<std::uint64_t> RefusalLog::next(std::chrono::steady_clock::time_point now) {
  auto state = state_.lock();
  const auto paid = std::max(state->paid_until, now) + std::chrono::seconds(1);
  if (paid > now + std::chrono::seconds(burst_)) {
    ++state->left_out;
    return std::nullopt;
  }
  state->paid_until = paid;
  return std::exchange(state->left_out, 0);
}

std::string RefusalLog::words_for(std::uint64_t left_out) {
  return left_out == 0 ? "" : " (" + std::to_string(left_out) + " more refused calls are not in the log)";
}

}  // namespace rt

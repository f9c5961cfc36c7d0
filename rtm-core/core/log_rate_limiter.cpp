#include "core/log_rate_limiter.h"

#include <algorithm>
#include <map>
#include <utility>

namespace rt {

std::optional<std::uint64_t> LogRateLimiter::State::next(unsigned burst, std::chrono::steady_clock::time_point now) {
  const auto paid = std::max(paid_until, now) + std::chrono::seconds(1);
  if (paid > now + std::chrono::seconds(burst)) {
    ++left_out;
    return std::nullopt;
  }
  paid_until = paid;
  return std::exchange(left_out, 0);
}

std::string LogRateLimiter::omitted_text(std::uint64_t left_out) {
  return left_out == 0 ? "" : " (" + std::to_string(left_out) + " more rejected calls are not in the log)";
}

std::optional<std::string> rejection_line_end(std::string_view name) {
  constexpr unsigned burst = 10;
  constexpr std::size_t max_names = 10'000;
  static base::Guarded<std::map<std::string, LogRateLimiter::State, std::less<>>, base::Rank::noted> states;
  std::optional<std::uint64_t> left_out;
  {
    auto locked = states.lock();
    auto state = locked->find(name);
    if (state == locked->end()) {
      if (locked->size() >= max_names) locked->clear();
      state = locked->try_emplace(std::string(name)).first;
    }
    left_out = state->second.next(burst, std::chrono::steady_clock::now());
  }
  if (!left_out) return std::nullopt;
  return LogRateLimiter::omitted_text(*left_out);
}

void log_rejection(base::Level level, std::string_view name, std::string_view message) {
  if (!base::is_logged(level)) return;
  if (const auto end = rejection_line_end(name)) base::log(level, name, "{}{}", message, *end);
}

}  // namespace rt

// Limits how often rejected calls are logged, so that a caller that repeats them does not fill the disk. Any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "base/guarded.h"
#include "base/log.h"

namespace rt {

// Allows one line per second, and `burst` lines at once after `burst` quiet seconds.
class LogRateLimiter {
 public:
  explicit LogRateLimiter(unsigned burst = 1) : burst_(burst) {}

  // The number of rejections that were left out before this one; nothing: this one is left out.
  std::optional<std::uint64_t> next(std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now()) {
    return state_.lock()->next(burst_, now);
  }
  // The end of a line: how many were left out before it; empty for none.
  static std::string omitted_text(std::uint64_t left_out);

  // One thread at a time.
  struct State {
    std::chrono::steady_clock::time_point paid_until = std::chrono::steady_clock::time_point::min();  // each line is worth a second
    std::uint64_t left_out = 0;
    std::optional<std::uint64_t> next(unsigned burst, std::chrono::steady_clock::time_point now);
  };

 private:
  unsigned burst_;
  base::Guarded<State, base::Rank::callbacks> state_;
};

// The limit of the object with this name in the process: ten lines at once. Returns the end of the line; nothing: the line is left out.
std::optional<std::string> rejection_line_end(std::string_view name);

// Logs a call that was rejected, or that failed because of another process, within that limit.
void log_rejection(base::Level level, std::string_view name, std::string_view message);
// The same with the logger of a component, port or context (RTC::Logger).
template <class Logger>
void log_rejection(const Logger& logger, int level, const std::string& message) {
  if (!logger.isValid(level)) return;
  if (const auto end = rejection_line_end(logger.getName())) logger.write(level, message + *end);
}

}  // namespace rt

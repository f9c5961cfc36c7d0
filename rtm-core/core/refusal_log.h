// Limits how often refused calls are logged, so that a caller that repeats them does not fill the disk. Any thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "base/guarded.h"

namespace rt {

// One line per second, and `burst` at once after so many quiet seconds.
class RefusalLog {
 public:
  explicit RefusalLog(unsigned burst = 1) : burst_(burst) {}

  // The number of refusals that were left out before this one; nothing: this one is left out.
  std::optional<std::uint64_t> next(std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now());
  // The end of a line: how many were left out before it; empty for none.
  static std::string words_for(std::uint64_t left_out);

 private:
  struct State {
    std::chrono::steady_clock::time_point paid_until = std::chrono::steady_clock::time_point::min();  // each line is worth a second
    std::uint64_t left_out = 0;
  };
  unsigned burst_;
  base::Guarded<State, base::Rank::callbacks> state_;
};

}  // namespace rt

// Limits how often a component logs a failure that each call of a remote client can cause. One thread at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace iface {

// One line per second, and eight at once after as many quiet seconds.
class LineLimit {
 public:
  // The line, with the number of those that were left out before it; nothing: this one is left out.
  std::optional<std::string> next(const std::string& line, std::chrono::steady_clock::time_point now = std::chrono::steady_clock::now());

 private:
  std::chrono::steady_clock::time_point paid_until_{};  // each line is worth a second
  std::uint64_t left_out_ = 0;
};

}  // namespace iface

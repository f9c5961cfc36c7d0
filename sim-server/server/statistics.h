// Where the time of the loop goes. The stepping thread only.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>

namespace sim {

enum class Part { requests, commands, physics, rays, sensors, publish, clients, pace };
inline constexpr std::array<std::string_view, 8> part_names = {"requests", "commands", "physics", "rays",
                                                               "sensors",  "publish",  "clients", "pace"};

class PartTimes {
 public:
  struct Entry {
    std::uint64_t calls = 0;
    std::chrono::nanoseconds total{0}, longest{0};
  };
  // The steps that are timed stand for as many: reading the clock eight times in each would cost more than a small world.
  static constexpr std::uint64_t stride = 8;

  void begin_step(std::uint64_t step) {
    is_timed_ = step % stride == 0;
    if (is_timed_) last_ = std::chrono::steady_clock::now();
  }
  // The time since the last mark belongs to `part`.
  void mark(Part part) {
    if (!is_timed_) return;
    const auto now = std::chrono::steady_clock::now();
    const auto took = std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_);
    auto& entry = entries_[static_cast<std::size_t>(part)];
    entry.calls += stride;
    entry.total += took * stride;
    if (took > entry.longest) entry.longest = took;
    last_ = now;
  }
  const std::array<Entry, part_names.size()>& entries() const { return entries_; }

 private:
  bool is_timed_ = false;
  std::chrono::steady_clock::time_point last_;
  std::array<Entry, part_names.size()> entries_;
};

}  // namespace sim

// Measures the parts of the loop's time. The stepping thread only.
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
  // One of so many steps is timed and stands for all of them: reading the clock eight times in each would cost more than a small world.
  static constexpr std::uint64_t stride = 8;

  void begin_step(std::uint64_t step) {
    stands_for_ = step % stride == 0 ? stride : 0;
    is_due_ = false;
    if (stands_for_ > 0) last_ = std::chrono::steady_clock::now();
  }
  // From here to end_due() every step is timed: a sensor's period may be a multiple of the stride, and then it would always or never be
  // seen. What has passed in this step since the last mark belongs to `searching`.
  void begin_due(Part searching) {
    add(searching, 0);
    if (stands_for_ == 0) last_ = std::chrono::steady_clock::now();
    is_due_ = true;
  }
  void end_due() { is_due_ = false; }
  // The time since the last mark belongs to `part`.
  void mark(Part part) { add(part, 1); }
  const std::array<Entry, part_names.size()>& entries() const { return entries_; }

 private:
  void add(Part part, std::uint64_t calls) {
    const std::uint64_t steps = is_due_ ? 1 : stands_for_;
    if (steps == 0) return;
    const auto now = std::chrono::steady_clock::now();
    const auto took = std::chrono::duration_cast<std::chrono::nanoseconds>(now - last_);
    auto& entry = entries_[static_cast<std::size_t>(part)];
    entry.calls += calls * steps;
    entry.total += took * steps;
    if (took > entry.longest) entry.longest = took;
    last_ = now;
  }

  std::uint64_t stands_for_ = 0;  // steps; 0: this one is not timed
  bool is_due_ = false;
  std::chrono::steady_clock::time_point last_;
  std::array<Entry, part_names.size()> entries_;
};

}  // namespace sim

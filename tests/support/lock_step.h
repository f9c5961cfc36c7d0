// A lock step without a simulator: its clock and its ticks, moved by hand.
#pragma once

#include "base/nondeterminism.h"
#include "base/tick.h"

namespace support {

// In a phase, always.
struct LockStep final : base::LockStepClock {
  std::chrono::nanoseconds now() const override { return time; }
  std::uint64_t epoch() const override { return runs; }
  std::uint64_t phase_counter() const override { return 1; }
  bool stands_still() const override { return is_paused; }
  std::chrono::nanoseconds time{0};
  std::uint64_t runs = 1;
  bool is_paused = false;
};

class TickAt final : public base::Tick {
 public:
  explicit TickAt(std::chrono::nanoseconds now) : now_(now) {}
  std::chrono::nanoseconds time() const override { return now_; }
  std::uint64_t phase_counter() const override { return 1; }
  void at_end(std::function<void(Tick&)>) override {}
  bool keeps_data() const override { return false; }
  void passed(const base::Passage&) override {}
  bool passed_again(const base::Passage&, std::uint64_t) override { return false; }

 private:
  const std::chrono::nanoseconds now_;
};

}  // namespace support

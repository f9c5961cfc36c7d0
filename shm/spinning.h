// Polls a word instead of sleeping, where a processor is free and the answer is expected sooner than a sleep and a wake-up take. Measured
// waits decide when. One thread at a time.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace shm {

// Between two looks at a word: who is waited for may have been woken on this very processor, and would wait for us.
void give_way();
// Of this process; who spins takes one from the others.
std::size_t processors();

// Whether there are processors that nobody else wants. Who spins on a busy machine keeps away those that it waits for; and no processor
// sleeps there, so that being woken is quick.
class FreeProcessors {
 public:
  // Of this machine.
  FreeProcessors();
  // `file`: as /proc/loadavg.
  FreeProcessors(const char* file, std::size_t all);
  ~FreeProcessors();
  FreeProcessors(const FreeProcessors&) = delete;
  FreeProcessors& operator=(const FreeProcessors&) = delete;

  static constexpr std::chrono::milliseconds pause{5};

  bool is_due(std::chrono::steady_clock::time_point now) const { return now >= next_look_ && file_ >= 0; }
  // Counts the threads that want to run, without the caller and those that take part; at most once in a pause.
  void look(std::chrono::steady_clock::time_point now, std::size_t taking_part = 0);
  // For the caller and so many others.
  bool are_there_for(std::size_t others) const;

 private:
  const int file_;
  const bool is_file_own_;
  const double all_;
  double wanted_;  // by others than the caller; a moving average
  std::chrono::steady_clock::time_point next_look_{};
};

// How long to look before one sleeps. It follows how long the news took the last times: a little longer than they usually do, and not at
// all when that is long. Who finds the other side slow, or the processors busy, therefore sleeps at once, and looks again when it is quick.
class SpinLimit {
 public:
  // More is not worth a processor.
  static constexpr std::chrono::nanoseconds longest = std::chrono::microseconds(400);

  explicit SpinLimit(std::chrono::nanoseconds most = longest) : most_(most) {}

  std::chrono::nanoseconds next() const;
  // From the beginning of the wait until the news, asleep or not.
  void took(std::chrono::nanoseconds wait);

 private:
  std::chrono::nanoseconds most_, usual_{0};
};

// The wait of one of two processes that ask and answer in turn. The other is among those who want to run, so it needs one processor more.
class TurnWait {
 public:
  TurnWait() = default;
  // See FreeProcessors.
  TurnWait(std::chrono::nanoseconds most, const char* file, std::size_t all) : free_(file, all), limit_(most) {}

  // Looks for the other's turn to end as long as SpinLimit says, at most until the deadline. False: sleep, then call slept().
  template <typename IsOver>
  bool look(const IsOver& is_over, std::chrono::steady_clock::time_point deadline) {
    began_ = std::chrono::steady_clock::now();
    free_.look(began_);
    is_measured_ = free_.are_there_for(0);
    if (!is_measured_) return false;
    for (const auto end = std::min(began_ + limit_.next(), deadline); !is_over(); give_way()) {
      if (std::chrono::steady_clock::now() >= end) return false;
    }
    slept();
    return true;
  }
  void slept() {
    if (std::exchange(is_measured_, false)) limit_.took(std::chrono::steady_clock::now() - began_);
  }

 private:
  FreeProcessors free_;
  SpinLimit limit_;
  std::chrono::steady_clock::time_point began_{};
  bool is_measured_ = false;
};

// How many steps before its tick a sleeper is woken, so that it is there when the tick begins. It learns from whether the sleeper was.
class WakeAhead {
 public:
  // Who is woken without a tick looks so long for one before it sleeps again.
  static constexpr std::chrono::nanoseconds longest = std::chrono::microseconds(150);
  static constexpr std::int64_t most_steps = 100;

  // 0: not before the tick.
  std::int64_t steps() const { return steps_; }
  // A tick begins for one that was woken `since` then.
  void began(std::chrono::nanoseconds since, bool is_awake);
  // A tick begins for one that was not.
  void began();

 private:
  std::int64_t steps_ = 1;
  std::uint32_t count_ = 0;
};

}  // namespace shm

// Polls a word instead of sleeping, if a processor is free and the answer is expected sooner than a sleep and a wake-up take. Measured
// waits decide that. One thread at a time.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace shm {

// Call it between two reads of a word: the awaited thread may be runnable on this very processor, and would wait for this thread.
void give_way();
// Processors that this process can use. A polling thread occupies one.
std::size_t processors();

// Estimates the number of idle processors. On a busy machine, polling delays the awaited threads; and processors do not sleep there, so a
// wake-up is quick.
class FreeProcessors {
 public:
  // Reads the load of this machine.
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
  // True if enough processors are free for the caller and this number of further threads.
  bool are_there_for(std::size_t others) const;

 private:
  const int file_;
  const bool is_file_own_;
  const double all_;
  double wanted_;  // by others than the caller; a moving average
  std::chrono::steady_clock::time_point next_look_{};
};

// The time to poll before a sleep. It follows the last waits: a little longer than usual, and zero if they are long. So a caller sleeps at
// once while the other side is slow or the processors are busy, and polls again when waits are short.
class SpinLimit {
 public:
  // A longer wait is not worth a processor.
  static constexpr std::chrono::nanoseconds longest = std::chrono::microseconds(400);

  explicit SpinLimit(std::chrono::nanoseconds most = longest) : most_(most) {}

  std::chrono::nanoseconds next() const;
  // The whole wait, asleep or not.
  void took(std::chrono::nanoseconds wait);

 private:
  std::chrono::nanoseconds most_, usual_{0};
};

// The wait of one of two processes that send requests and replies alternately. The other one is runnable, too, so one more processor is
// needed.
class TurnWait {
 public:
  TurnWait() = default;
  // See FreeProcessors.
  TurnWait(std::chrono::nanoseconds most, const char* file, std::size_t all) : free_(file, all), limit_(most) {}

  // Polls until is_over(), as long as SpinLimit allows and at most until the deadline. False: sleep, then call slept().
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

// The number of steps before its tick at which a sleeper is woken, so that it is awake when the tick begins. It adapts to earlier ticks.
class WakeAhead {
 public:
  // Maximum time for which a woken thread polls for its tick before it sleeps again.
  static constexpr std::chrono::nanoseconds longest = std::chrono::microseconds(150);
  static constexpr std::int64_t max_steps = 100;

  // 0: not before the tick.
  std::int64_t steps() const { return steps_; }
  // A tick begins for a sleeper that was woken `since` before it.
  void began(std::chrono::nanoseconds since, bool is_awake);
  // A tick begins for a sleeper that was not woken before.
  void began();

 private:
  std::int64_t steps_ = 1;
  std::uint32_t count_ = 0;
};

}  // namespace shm

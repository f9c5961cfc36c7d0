// Polls a word instead of sleeping, where a processor is free and the answer is expected sooner than a sleep and a wake-up take. Measured
// waits decide when. One thread at a time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace shm {

// Between two looks at a word: who is waited for may have been woken on this very processor, and would wait for us.
void give_way();
// Of this process; who spins takes one from the others.
std::size_t processors();

// Whether there are processors that nobody else wants. Who spins on a busy machine keeps away those that it waits for; and no processor
// sleeps there, so that being woken is quick.
class FreeProcessors {
 public:
  // `file`: as /proc/loadavg.
  explicit FreeProcessors(const char* file = "/proc/loadavg", std::size_t all = processors());
  ~FreeProcessors();
  FreeProcessors(const FreeProcessors&) = delete;
  FreeProcessors& operator=(const FreeProcessors&) = delete;

  static constexpr std::chrono::milliseconds pause{5};

  // Counts who wants to run, at most once in a pause; at a time when of those who take part only the caller does.
  void look(std::chrono::steady_clock::time_point now);
  // For the caller and so many others.
  bool are_there_for(std::size_t others) const;

 private:
  const int file_;
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

  std::chrono::nanoseconds next() const;
  // From the beginning of the wait until the news, asleep or not.
  void took(std::chrono::nanoseconds wait);

 private:
  std::chrono::nanoseconds usual_{0};
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

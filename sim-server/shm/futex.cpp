#include "shm/futex.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <climits>

#include "shm/words.h"

namespace shm {

void futex_wait(const std::uint32_t& word, std::uint32_t expected, std::chrono::nanoseconds timeout) {
  if (timeout.count() <= 0) return;
  timespec time{};
  time.tv_sec = static_cast<time_t>(timeout.count() / 1'000'000'000);
  time.tv_nsec = static_cast<long>(timeout.count() % 1'000'000'000);
  syscall(SYS_futex, &word, FUTEX_WAIT, expected, &time, nullptr, 0);
}

void futex_wake(const std::uint32_t& word, int count) { syscall(SYS_futex, &word, FUTEX_WAKE, count, nullptr, nullptr, 0); }

void futex_wait_bits(const std::uint32_t& word, std::uint32_t expected, std::uint32_t bits,
                     std::chrono::steady_clock::time_point deadline) {
  const std::int64_t end = std::chrono::duration_cast<std::chrono::nanoseconds>(deadline.time_since_epoch()).count();
  timespec time{};  // CLOCK_MONOTONIC, which is what steady_clock shows
  time.tv_sec = static_cast<time_t>(end / 1'000'000'000);
  time.tv_nsec = static_cast<long>(end % 1'000'000'000);
  syscall(SYS_futex, &word, FUTEX_WAIT_BITSET, expected, &time, nullptr, bits);
}

void futex_wake_bits(const std::uint32_t& word, std::uint32_t bits) {
  syscall(SYS_futex, &word, FUTEX_WAKE_BITSET, INT_MAX, nullptr, nullptr, bits);
}

void announce(std::uint32_t& waiting) { store(waiting, 1U, std::memory_order_seq_cst); }  // pairs with the load in ring

void ring(std::uint32_t& word, std::uint32_t& waiting) {
  if (load(waiting, std::memory_order_seq_cst) == 0) return;  // pairs with announce
  // A sleeper that announces itself between these two lines finds the word changed already, or is woken. One that has seen the change and
  // is about to wait for the next loses its announcement: sleepers wait for a limited time, or look at `waiting` again after the word.
  store(waiting, 0U, std::memory_order_seq_cst);
  futex_wake(word, INT_MAX);
}

}  // namespace shm

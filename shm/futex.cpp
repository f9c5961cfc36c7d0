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

namespace {

// Never 0. That two values 2^31 news apart look the same costs a system call, no more.
std::uint32_t announcement_of(std::uint32_t seen) { return seen << 1 | 1U; }

}  // namespace

void announce(std::uint32_t& waiting, std::uint32_t seen) {
  store(waiting, announcement_of(seen), std::memory_order_seq_cst);  // pairs with the load in ring
}

void ring(std::uint32_t& word, std::uint32_t& waiting) {
  std::uint32_t stands = load(waiting, std::memory_order_seq_cst);  // pairs with announce
  if (stands == 0) return;
  // Taken back only if its sleeper has not seen what the word is now: such a one is woken below, or finds the word changed. One who has
  // seen it waits for the next news already, and whoever brings them must find the announcement.
  if (stands != announcement_of(load(word, std::memory_order_seq_cst))) shm::word(waiting).compare_exchange_strong(stands, 0U);
  futex_wake(word, INT_MAX);
}

}  // namespace shm

// Sleeps on, and wakes by, a 32-bit word that processes share. Any thread.
#pragma once

#include <chrono>
#include <cstdint>

namespace shm {

// Sleeps while word == expected, at most `timeout` (none when <= 0). Returns early for no reason at times; look at the word again.
void futex_wait(const std::uint32_t& word, std::uint32_t expected, std::chrono::nanoseconds timeout);
// Wakes at most `count` sleepers.
void futex_wake(const std::uint32_t& word, int count);

// Sleepers on one word that are told apart by bits: a wake reaches those whose bits are among `bits`.
void futex_wait_bits(const std::uint32_t& word, std::uint32_t expected, std::uint32_t bits, std::chrono::steady_clock::time_point deadline);
void futex_wake_bits(const std::uint32_t& word, std::uint32_t bits);

// Sleep and wake without a system call when nobody sleeps. The sleeper, who has seen a value of the word:
//   announce(waiting, seen); if (the word is still the same) futex_wait(word, seen, ...)
// the waker, after it stored the news: ring(word, waiting). The announcement mends itself when a sleeper dies: the next ring but one takes
// it back. It says what its sleeper has seen, so that a waker who comes late leaves it to those who will bring the next news.
void announce(std::uint32_t& waiting, std::uint32_t seen);  // seq_cst store, pairs with the seq_cst load in ring
void ring(std::uint32_t& word, std::uint32_t& waiting);     // the word must have changed before, with a seq_cst store

}  // namespace shm

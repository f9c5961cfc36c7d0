// Atomic access to words of shared memory, and copying of samples. Any thread, any process.
//
// A sample is copied word by word with release stores and acquire loads: a reader that sees one word of a new sample also sees that its
// lock word is odd (or newer), without any fence; on x86 these are plain moves.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace shm {

template <class T>
std::atomic_ref<T> word(T& value) {
  static_assert(std::atomic_ref<T>::is_always_lock_free);
  return std::atomic_ref<T>(value);
}
template <class T>
T load(const T& value, std::memory_order order = std::memory_order_acquire) {
  return std::atomic_ref<T>(const_cast<T&>(value)).load(order);
}
template <class T>
void store(T& value, T wanted, std::memory_order order = std::memory_order_release) {
  std::atomic_ref<T>(value).store(wanted, order);
}

// Both addresses are multiples of 8; size is rounded up to words, so both blocks have room for that.
void copy_in(void* shared, const void* own, std::size_t size);   // pairs with copy_out
void copy_out(void* own, const void* shared, std::size_t size);  // pairs with copy_in

constexpr std::size_t round_up(std::size_t size, std::size_t to) { return (size + to - 1) / to * to; }

}  // namespace shm

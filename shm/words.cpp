#include "shm/words.h"

namespace shm {

void copy_in(void* shared, const void* own, std::size_t size) {
  auto* to = static_cast<std::uint64_t*>(shared);
  const auto* from = static_cast<const std::uint64_t*>(own);
  const std::size_t words = round_up(size, 8) / 8;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < words; ++i) store(to[i], from[i], std::memory_order_release);
}

void copy_out(void* own, const void* shared, std::size_t size) {
  auto* to = static_cast<std::uint64_t*>(own);
  const auto* from = static_cast<const std::uint64_t*>(shared);
  const std::size_t words = round_up(size, 8) / 8;
#pragma GCC unroll 8
  for (std::size_t i = 0; i < words; ++i) to[i] = load(from[i], std::memory_order_acquire);
}

}  // namespace shm

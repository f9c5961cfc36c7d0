#include "fuzz/memory_budget.h"

#include <malloc.h>
#include <sanitizer/asan_interface.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <mutex>
#include <new>
#include <utility>

// All functions of this file that allocate or release lie side by side; the linker knows where.
#define ALLOCATION __attribute__((noinline, section("allocations")))
extern "C" const char __start_allocations[], __stop_allocations[];

namespace {

// Relaxed: sums alone; nothing is read because of them.
std::atomic<long> left{0};
std::atomic<bool> is_limited{false};

// Large blocks that were released, poisoned until they are used again: some parsers take 16 MiB for each file, and the sanitizer's
// allocator would return the pages to the system each time, which takes longer than the file.
class LargeBlocks {
 public:
  static constexpr std::size_t smallest = 1 << 20;  // [byte]

  void* take(std::size_t size) {
    const std::lock_guard<std::mutex> mine(turn_);
    for (void*& block : blocks_) {
      if (block == nullptr || malloc_usable_size(block) != size) continue;
      ASAN_UNPOISON_MEMORY_REGION(block, size);
      return std::exchange(block, nullptr);
    }
    return nullptr;
  }
  bool keep(void* memory) {
    const std::lock_guard<std::mutex> mine(turn_);
    for (void*& block : blocks_) {
      if (block != nullptr) continue;
      block = memory;
      ASAN_POISON_MEMORY_REGION(block, malloc_usable_size(block));
      return true;
    }
    return false;
  }

 private:
  std::mutex turn_;
  std::array<void*, 4> blocks_{};
};
LargeBlocks large_blocks;

ALLOCATION void* allocate(std::size_t size) noexcept {
  if (!is_limited.load(std::memory_order_relaxed)) return std::malloc(size);
  const auto wanted = static_cast<long>(size);
  if (wanted < 0 || left.load(std::memory_order_relaxed) < wanted) return nullptr;
  void* memory = size >= LargeBlocks::smallest ? large_blocks.take(size) : nullptr;
  if (memory == nullptr) memory = std::malloc(size);
  if (memory != nullptr) left.fetch_sub(static_cast<long>(malloc_usable_size(memory)), std::memory_order_relaxed);
  return memory;
}

ALLOCATION void* allocate_or_throw(std::size_t size) {
  void* memory = allocate(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

ALLOCATION void release(void* memory) noexcept {
  if (is_limited.load(std::memory_order_relaxed)) {
    const std::size_t size = malloc_usable_size(memory);
    left.fetch_add(static_cast<long>(size), std::memory_order_relaxed);
    if (size >= LargeBlocks::smallest && large_blocks.keep(memory)) return;
  }
  std::free(memory);
}

}  // namespace

namespace fuzz {

void limit_memory(std::size_t bytes) {
  left.store(static_cast<long>(bytes), std::memory_order_relaxed);
  is_limited.store(true, std::memory_order_relaxed);
}

bool is_allocation(std::uintptr_t address) {
  return address >= reinterpret_cast<std::uintptr_t>(__start_allocations) &&
         address <= reinterpret_cast<std::uintptr_t>(__stop_allocations);
}

}  // namespace fuzz

ALLOCATION void* operator new(std::size_t size) { return allocate_or_throw(size); }
ALLOCATION void* operator new[](std::size_t size) { return allocate_or_throw(size); }
ALLOCATION void* operator new(std::size_t size, const std::nothrow_t& /*unused*/) noexcept { return allocate(size); }
ALLOCATION void* operator new[](std::size_t size, const std::nothrow_t& /*unused*/) noexcept { return allocate(size); }
ALLOCATION void operator delete(void* memory) noexcept { release(memory); }
ALLOCATION void operator delete[](void* memory) noexcept { release(memory); }
ALLOCATION void operator delete(void* memory, std::size_t /*unused*/) noexcept { release(memory); }
ALLOCATION void operator delete[](void* memory, std::size_t /*unused*/) noexcept { release(memory); }
ALLOCATION void operator delete(void* memory, const std::nothrow_t& /*unused*/) noexcept { release(memory); }
ALLOCATION void operator delete[](void* memory, const std::nothrow_t& /*unused*/) noexcept { release(memory); }

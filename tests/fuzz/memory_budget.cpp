#include "fuzz/memory_budget.h"

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

// Relaxed: sums alone; nothing is read because of them.
std::atomic<long> left{0};
std::atomic<bool> is_limited{false};

void* allocate(std::size_t size) noexcept {
  if (!is_limited.load(std::memory_order_relaxed)) return std::malloc(size);
  const auto wanted = static_cast<long>(size);
  if (wanted < 0 || left.load(std::memory_order_relaxed) < wanted) return nullptr;
  void* memory = std::malloc(size);
  if (memory != nullptr) left.fetch_sub(static_cast<long>(malloc_usable_size(memory)), std::memory_order_relaxed);
  return memory;
}

void* allocate_or_throw(std::size_t size) {
  void* memory = allocate(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void release(void* memory) noexcept {
  if (is_limited.load(std::memory_order_relaxed)) left.fetch_add(static_cast<long>(malloc_usable_size(memory)), std::memory_order_relaxed);
  std::free(memory);
}

}  // namespace

namespace fuzz {

void limit_memory(std::size_t bytes) {
  left.store(static_cast<long>(bytes), std::memory_order_relaxed);
  is_limited.store(true, std::memory_order_relaxed);
}

}  // namespace fuzz

void* operator new(std::size_t size) { return allocate_or_throw(size); }
void* operator new[](std::size_t size) { return allocate_or_throw(size); }
void* operator new(std::size_t size, const std::nothrow_t& /*unused*/) noexcept { return allocate(size); }
void* operator new[](std::size_t size, const std::nothrow_t& /*unused*/) noexcept { return allocate(size); }
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t /*unused*/) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t /*unused*/) noexcept { release(memory); }
void operator delete(void* memory, const std::nothrow_t& /*unused*/) noexcept { release(memory); }
void operator delete[](void* memory, const std::nothrow_t& /*unused*/) noexcept { release(memory); }

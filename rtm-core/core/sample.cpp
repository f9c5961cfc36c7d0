#include "core/sample.h"

#include <sys/mman.h>

#include <cstdlib>
#include <new>

namespace rt {

namespace {

constexpr std::size_t huge_page = std::size_t{2} << 20;
constexpr std::size_t alignment = 64;

std::byte* allocate(std::size_t capacity) {
  // Large blocks live long in their pools; on huge pages the kernel copies into them with far fewer look-ups.
  const std::size_t unit = capacity >= huge_page / 2 ? huge_page : alignment;
  if (capacity > SIZE_MAX - unit) throw std::bad_alloc();
  const std::size_t size = (capacity + unit - 1) / unit * unit;
  void* memory = std::aligned_alloc(unit, size ? size : unit);
  if (!memory) throw std::bad_alloc();
  if (unit == huge_page) madvise(memory, size, MADV_HUGEPAGE);  // a wish
  return static_cast<std::byte*>(memory);
}

}  // namespace

void Block::Free::operator()(std::byte* memory) const { std::free(memory); }

Block::Block(std::size_t capacity) : data_(allocate(capacity)), capacity_(capacity) {}

std::shared_ptr<Block> BlockPool::take(std::size_t size) {
  std::unique_ptr<Block> block;
  {
    auto kept = kept_.lock();
    for (std::size_t i = 0; i < kept->count; ++i) {
      if (kept->blocks[i]->capacity() < size) continue;
      block = std::move(kept->blocks[i]);
      kept->blocks[i] = std::move(kept->blocks[--kept->count]);
      break;
    }
  }
  if (!block) block = std::make_unique<Block>(size < 64 ? 64 : size);
  block->set_size(size);
  return std::shared_ptr<Block>(block.release(), [pool = shared_from_this()](Block* used) { pool->give_back(used); });
}

void BlockPool::give_back(Block* block) {
  std::unique_ptr<Block> used(block);
  auto kept = kept_.lock();
  if (kept->count < Kept::limit) {
    kept->blocks[kept->count++] = std::move(used);
    return;
  }
  // The smallest goes, so that a port of large samples does not end with small blocks only.
  for (auto& other : kept->blocks) {
    if (other->capacity() < used->capacity()) std::swap(other, used);
  }
}

}  // namespace rt

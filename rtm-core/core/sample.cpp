#include "core/sample.h"

#include <new>

namespace rt {

Block::Block(std::size_t capacity) : data_(std::make_unique_for_overwrite<std::byte[]>(capacity)), capacity_(capacity) {}

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

// One sample of a data port: bytes in the encoding of the wire, or inside a process the value itself. Immutable once written, shared.
// Any thread.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "base/guarded.h"

namespace rt {

// A buffer of octets, aligned to 16, whose contents are not initialised.
class Block {
 public:
  explicit Block(std::size_t capacity);
  std::byte* data() { return data_.get(); }
  const std::byte* data() const { return data_.get(); }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  std::span<const std::byte> octets() const { return {data_.get(), size_}; }
  // size <= capacity().
  void set_size(std::size_t size) { size_ = size; }

 private:
  struct Free {
    void operator()(std::byte* memory) const;
  };
  std::unique_ptr<std::byte, Free> data_;
  std::size_t capacity_;
  std::size_t size_ = 0;
};

// Hands out blocks and takes them back when their last user lets go, so that a steady stream of samples allocates nothing large.
class BlockPool : public std::enable_shared_from_this<BlockPool> {
 public:
  static std::shared_ptr<BlockPool> make() { return std::shared_ptr<BlockPool>(new BlockPool); }
  // size() of the block is `size`.
  std::shared_ptr<Block> take(std::size_t size);

 private:
  struct Kept {
    static constexpr std::size_t limit = 4;
    std::unique_ptr<Block> blocks[limit];
    std::size_t count = 0;
  };
  BlockPool() = default;
  void give_back(Block* block);

  base::Guarded<Kept, base::Rank::memory> kept_;
};

enum class ByteOrder { little, big };

struct Sample {
  std::shared_ptr<const Block> block;  // either this, in `order`,
  std::shared_ptr<const void> value;   // or this, a value of a type that is known to those who made it
  ByteOrder order = ByteOrder::little;
  std::uint64_t arrival = 0;            // counts up over all connections of a port
  std::chrono::nanoseconds received{};  // when the port got it, by the clock of the thread that brought it; 0 if nobody asked

  std::uint64_t epoch = 0;          // of the clock of the port's component, when it came or was written
  std::uint64_t phase_counter = 0;  // likewise

  std::optional<std::uint64_t> hash;  // of the value as it is written down without a codec, where a tick has looked at it (base/tick.h)

  explicit operator bool() const { return block || value; }
};

// The memory of a sample that waits, about; 0 for a value, whose size only its type knows.
inline std::size_t octets_of(const Sample& sample) {
  constexpr std::size_t around_it = 256;
  return sample.block ? sample.block->capacity() + around_it : 0;
}

// The most memory that samples take that wait in one buffer: more waits nowhere, however many places the connection asks for.
inline constexpr std::size_t max_octets_waiting = std::size_t{1} << 30;

}  // namespace rt

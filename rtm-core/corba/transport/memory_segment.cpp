#include "corba/transport/memory_segment.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "base/guarded.h"
#include "base/text.h"

namespace corba {
namespace {

base::Error failure(std::string_view what, const std::string& name) {
  return {"shared memory " + base::in_quotes(name) + ": " + std::string(what) + ": " + std::generic_category().message(errno)};
}

// A plain name: nothing that leads out of the folder of segments, and nothing of the simulator's (shm/segment.h), which is no peer's to
// show.
bool is_plain(const std::string& name) {
  const std::string_view plain = std::string_view(name).substr(name.starts_with('/') ? 1 : 0);
  return !plain.empty() && plain.size() < 200 && !plain.starts_with("rtmsim-") && plain != "." && plain != ".." &&
         plain.find_first_not_of("0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ-_.") == std::string_view::npos;
}

std::string path_of(const std::string& name) { return name.starts_with('/') ? name : "/" + name; }

std::uint64_t in_order(std::uint64_t value, rt::ByteOrder order) {
  const bool is_native = (std::endian::native == std::endian::little) == (order == rt::ByteOrder::little);
  return is_native ? value : __builtin_bswap64(value);
}

}  // namespace

base::Result<std::unique_ptr<MemorySegment>> MemorySegment::create(const std::string& name, std::size_t size) {
  base::expect_no_data_held();
  if (!is_plain(name)) return base::Error{"shared memory " + base::in_quotes(name) + ": no name for a segment"};
  const int file = shm_open(path_of(name).c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return failure("cannot be made", name);
  std::unique_ptr<MemorySegment> segment(new MemorySegment(name, file, size));
  segment->is_named_ = true;
  if (ftruncate(file, static_cast<off_t>(size)) != 0) return failure("cannot be made that long", name);
  if (auto mapped = segment->map(PROT_READ | PROT_WRITE); !mapped) return mapped.error();
  return segment;
}

base::Result<std::unique_ptr<MemorySegment>> MemorySegment::open(const std::string& name) {
  base::expect_no_data_held();
  if (!is_plain(name)) return base::Error{"shared memory " + base::in_quotes(name) + ": no name for a segment"};
  // Whatever a peer has put there in place of a segment: nobody waits for a fifo.
  const int file = shm_open(path_of(name).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0);
  if (file < 0) return failure("cannot be opened", name);
  std::unique_ptr<MemorySegment> segment(new MemorySegment(name, file, 0));
  struct stat status {};
  if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
    return base::Error{"shared memory " + base::in_quotes(name) + ": is no segment"};
  }
  if (static_cast<std::size_t>(status.st_size) < header) return base::Error{"shared memory " + base::in_quotes(name) + ": too short"};
  segment->size_ = static_cast<std::size_t>(status.st_size);
  if (auto mapped = segment->map(PROT_READ); !mapped) return mapped.error();
  return segment;
}

base::Result<void> MemorySegment::map(int protection) {
  void* memory = mmap(nullptr, size_, protection, MAP_SHARED, file_, 0);
  if (memory == MAP_FAILED) return failure("cannot be mapped", name_);
  memory_ = static_cast<std::byte*>(memory);
  guard_.emplace(memory_, size_);
  return {};
}

MemorySegment::~MemorySegment() {
  unlink();
  guard_.reset();
  if (memory_) munmap(memory_, size_);
  close(file_);
}

void MemorySegment::unlink() {
  base::expect_no_data_held();
  if (is_named_) shm_unlink(path_of(name_).c_str());
  is_named_ = false;
}

base::Result<void> MemorySegment::write(const Pieces& pieces, rt::ByteOrder order) {
  if (!memory_ || size_ < header || pieces.size > size_ - header)
    return base::Error{"shared memory " + name_ + ": too short for the sample"};
  const std::uint64_t length = in_order(pieces.size, order);
  std::memcpy(memory_, &length, sizeof length);
  std::byte* to = memory_ + header;
  for (const auto& part : pieces.parts) {
    std::memcpy(to, part.data(), part.size());
    to += part.size();
  }
  if (base::was_cut(memory_)) return base::Error{"shared memory " + name_ + ": the reader has cut it short"};
  return {};
}

base::Result<std::shared_ptr<rt::Block>> MemorySegment::read(rt::ByteOrder order, rt::BlockPool& pool) {
  struct stat status {};
  if (fstat(file_, &status) != 0 || static_cast<std::size_t>(status.st_size) < size_) {
    return base::Error{"shared memory " + name_ + ": has become shorter"};
  }
  std::uint64_t length = 0;
  std::memcpy(&length, memory_, sizeof length);
  length = in_order(length, order);
  if (length > size_ - header) return base::Error{"shared memory " + name_ + ": the sample is longer than the segment"};
  if (length > longest) return base::Error{"shared memory " + name_ + ": the sample is longer than " + std::to_string(longest)};
  auto block = pool.take(length);
  std::memcpy(block->data(), memory_ + header, length);
  if (base::was_cut(memory_)) return base::Error{"shared memory " + name_ + ": has become shorter"};
  return block;
}

}  // namespace corba

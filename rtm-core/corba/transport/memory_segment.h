// One sample in a named POSIX shared-memory segment: 8 bytes of length in the connection's byte order, then the payload.
// One thread at a time. What the other process writes is not trusted: lengths are checked, and a segment that it cuts short becomes an
// error (base/cut_guard.h).
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "base/cut_guard.h"
#include "base/result.h"
#include "corba/transport/payload.h"
#include "core/sample.h"

namespace corba {

class MemorySegment {
 public:
  // A new segment of that size [octets], readable by this user only.
  static base::Result<std::unique_ptr<MemorySegment>> create(const std::string& name, std::size_t size);
  // One that a peer has made.
  static base::Result<std::unique_ptr<MemorySegment>> open(const std::string& name);
  ~MemorySegment();
  MemorySegment(const MemorySegment&) = delete;
  MemorySegment& operator=(const MemorySegment&) = delete;

  static constexpr std::size_t header = 8;
  static constexpr std::size_t longest = std::size_t{256} << 20;  // [octets], of samples that are read
  std::size_t size() const { return size_; }
  const std::string& name() const { return name_; }
  // pieces.size + header <= size().
  base::Result<void> write(const Pieces& pieces, rt::ByteOrder order);
  base::Result<std::shared_ptr<rt::Block>> read(rt::ByteOrder order, rt::BlockPool& pool);
  // Takes the name away; who has the segment open keeps it.
  void unlink();

 private:
  base::Result<void> map(int protection);
  MemorySegment(std::string name, int file, std::size_t size) : name_(std::move(name)), file_(file), size_(size) {}
  std::string name_;
  int file_;
  std::size_t size_;
  std::byte* memory_ = nullptr;
  std::optional<base::CutGuard> guard_{};
  bool is_named_ = false;
};

}  // namespace corba

#include "corba/transport/gather_stream.h"

#include "corba/transport/cdr.h"

namespace corba {
namespace {

// Below this, copying is cheaper than one more piece.
constexpr int shortest_borrowed = 4096;

}  // namespace

void GatherStream::start(rt::ByteOrder order, bool gathers) {
  forget_contents(*this);
  setByteSwapFlag(order == rt::ByteOrder::little);
  borrowed_.clear();
  gathers_ = gathers;
}

void GatherStream::put_octet_array(const _CORBA_Octet* octets, int size, omni::alignment_t align) {
  if (!gathers_ || size < shortest_borrowed) return cdrMemoryStream::put_octet_array(octets, size, align);
  // A few octets stand in for the array in our memory, so that what comes after it is aligned as if the array were there.
  const int stand_in = size % 8 + 8;
  cdrMemoryStream::put_octet_array(octets, stand_in, align);
  const std::size_t end = bufSize();
  borrowed_.push_back({end - static_cast<std::size_t>(stand_in), end, std::as_bytes(std::span(octets, static_cast<std::size_t>(size)))});
}

Pieces GatherStream::pieces() const {
  Pieces pieces;
  pieces.parts.reserve(borrowed_.size() * 2 + 1);
  const auto* memory = static_cast<const std::byte*>(bufPtr());
  std::size_t start = 0;
  const auto add = [&](std::span<const std::byte> part) {
    if (part.empty()) return;
    pieces.parts.push_back(part);
    pieces.size += part.size();
  };
  for (const auto& borrowed : borrowed_) {
    add({memory + start, borrowed.copied_end - start});
    add(borrowed.octets);
    start = borrowed.copied_start;
  }
  add({memory + start, bufSize() - start});
  return pieces;
}

}  // namespace corba

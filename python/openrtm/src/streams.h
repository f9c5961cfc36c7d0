// Writers and readers of CDR: numbers, arrays of numbers and bytes, over plain memory (flat types) and over streams of the ORB. Used by one
// thread at a time. Readers throw BadOctets when the data ends early.
#pragma once

#include <omniORB4/CORBA.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>
#include <utility>

#include "coder.h"

namespace python {

template <class Number>
Number swapped(Number number) {
  std::byte octets[sizeof number];
  std::memcpy(octets, &number, sizeof number);
  for (std::size_t i = 0; i < sizeof number / 2; ++i) std::swap(octets[i], octets[sizeof number - 1 - i]);
  std::memcpy(&number, octets, sizeof number);
  return number;
}

inline bool is_foreign(bool is_little) { return is_little != (std::endian::native == std::endian::little); }

// --- writers and readers: numbers, arrays of numbers, octets

class FlatWriter {
 public:
  FlatWriter(Octets& to, bool is_little) : to_(to), swaps_(is_foreign(is_little)) {}
  template <class Number>
  void put(Number number) {
    if (swaps_) number = swapped(number);
    std::memcpy(room(sizeof number, sizeof number), &number, sizeof number);
  }
  template <class Number>
  void numbers(const Number* first, std::size_t count) {
    if (count == 0) return;
    std::byte* to = room(sizeof(Number) * count, sizeof(Number));
    if (!swaps_) {
      std::memcpy(to, first, sizeof(Number) * count);
      return;
    }
    for (std::size_t i = 0; i < count; ++i) {
      const Number one = swapped(first[i]);
      std::memcpy(to + i * sizeof one, &one, sizeof one);
    }
  }
  void octets(const void* from, std::size_t count) {
    if (count) std::memcpy(room(count, 1), from, count);
  }
  cdrStream* stream() { return nullptr; }

 private:
  std::byte* room(std::size_t size, std::size_t alignment) {
    const std::size_t start = (to_.size() + alignment - 1) / alignment * alignment;
    to_.resize(start + size);
    return to_.data() + start;
  }
  Octets& to_;
  const bool swaps_;
};

class StreamWriter {
 public:
  explicit StreamWriter(cdrStream& stream) : stream_(stream) {}
  template <class Number>
  void put(Number number) {
    if constexpr (std::is_same_v<Number, float>)
      stream_.marshalFloat(number);
    else if constexpr (std::is_same_v<Number, double>)
      stream_.marshalDouble(number);
    else if constexpr (sizeof number == 1)
      stream_.marshalOctet(static_cast<CORBA::Octet>(number));
    else if constexpr (sizeof number == 2)
      stream_.marshalUShort(static_cast<CORBA::UShort>(number));
    else if constexpr (sizeof number == 4)
      stream_.marshalULong(static_cast<CORBA::ULong>(number));
    else
      stream_.marshalULongLong(static_cast<CORBA::ULongLong>(number));
  }
  template <class Number>
  void numbers(const Number* first, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) put(first[i]);
  }
  void octets(const void* from, std::size_t count) {
    if (count) stream_.put_octet_array(static_cast<const CORBA::Octet*>(from), static_cast<int>(count));
  }
  cdrStream* stream() { return &stream_; }

 private:
  cdrStream& stream_;
};

class FlatReader {
 public:
  FlatReader(std::span<const std::byte> from, bool is_little) : from_(from), swaps_(is_foreign(is_little)) {}
  template <class Number>
  Number get() {
    Number number;
    std::memcpy(&number, part(sizeof number, sizeof number), sizeof number);
    return swaps_ ? swapped(number) : number;
  }
  // Good until the next call.
  const std::byte* octets(std::size_t count) { return part(count, 1); }
  // Before memory is taken for a length: `size` octets at least for each element.
  void expect(std::size_t count, std::size_t size) const {
    if (count > (from_.size() - at_) / size) throw BadOctets{};
  }
  cdrStream* stream() { return nullptr; }

 private:
  const std::byte* part(std::size_t size, std::size_t alignment) {
    const std::size_t start = (at_ + alignment - 1) / alignment * alignment;
    if (start > from_.size() || size > from_.size() - start) throw BadOctets{};
    at_ = start + size;
    return from_.data() + start;
  }
  const std::span<const std::byte> from_;
  std::size_t at_ = 0;
  const bool swaps_;
};

class StreamReader {
 public:
  explicit StreamReader(cdrStream& stream) : stream_(stream) {}
  template <class Number>
  Number get() {
    if constexpr (std::is_same_v<Number, float>)
      return stream_.unmarshalFloat();
    else if constexpr (std::is_same_v<Number, double>)
      return stream_.unmarshalDouble();
    else if constexpr (sizeof(Number) == 1)
      return static_cast<Number>(stream_.unmarshalOctet());
    else if constexpr (sizeof(Number) == 2)
      return static_cast<Number>(stream_.unmarshalUShort());
    else if constexpr (sizeof(Number) == 4)
      return static_cast<Number>(stream_.unmarshalULong());
    else
      return static_cast<Number>(stream_.unmarshalULongLong());
  }
  const std::byte* octets(std::size_t count) {
    expect(count, 1);
    buffer_.resize(count + 1);
    if (count) stream_.get_octet_array(reinterpret_cast<CORBA::Octet*>(buffer_.data()), static_cast<int>(count));
    return buffer_.data();
  }
  void expect(std::size_t count, std::size_t) const {
    if (count > 0x7fffffff || !stream_.checkInputOverrun(1, static_cast<CORBA::ULong>(count))) throw BadOctets{};
  }
  cdrStream* stream() { return &stream_; }

 private:
  cdrStream& stream_;
  Octets buffer_;
};

}  // namespace python

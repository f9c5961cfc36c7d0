// One value to send, encoded at most once per byte order and copied at most once, for any number of connections. One thread at a
// time.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "corba/transport/type_ops.h"
#include "core/sample.h"

namespace corba {

// The encoded value in pieces, to be sent one after the other.
struct Pieces {
  std::vector<std::span<const std::byte>> parts;
  std::size_t size = 0;
};

class GatherStream;

class Payload {
 public:
  // The value must stay as it is as long as this lives.
  Payload(const TypeOps& ops, const void* value);
  Payload(const TypeOps& ops, rt::Sample sample);
  ~Payload();
  Payload(const Payload&) = delete;
  Payload& operator=(const Payload&) = delete;

  const TypeOps& ops() const { return ops_; }
  // Long arrays are left where they are in the value. Good as long as this lives. Throws CORBA::SystemException if the value cannot be
  // encoded, e.g. an enumerator that is none.
  const Pieces& pieces(rt::ByteOrder order);
  // Encoded, for keeping.
  rt::Sample encoded(rt::ByteOrder order, rt::BlockPool& pool);
  // The value itself, for keeping.
  rt::Sample copied();
  // nullptr if it came encoded and is no value of the type.
  const void* value();
  // Of the value, for those who read it.
  void set_hash(std::optional<std::uint64_t> hash) { hash_ = hash; }

 private:
  struct Encoded {
    std::unique_ptr<GatherStream> stream;
    std::optional<Pieces> pieces;
    std::shared_ptr<const rt::Block> block;
  };

  const TypeOps& ops_;
  const void* value_ = nullptr;
  std::shared_ptr<const void> copy_;
  Encoded encoded_[2];  // by rt::ByteOrder
  std::optional<std::uint64_t> hash_;
};

}  // namespace corba

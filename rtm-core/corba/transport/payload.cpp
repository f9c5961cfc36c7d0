#include "corba/transport/payload.h"

#include <cstring>
#include <utility>

#include "base/guarded.h"
#include "corba/transport/cdr.h"
#include "corba/transport/gather_stream.h"

namespace corba {
namespace {

// Streams keep their memory; a few wait here for the next value.
class StreamPool {
 public:
  std::unique_ptr<GatherStream> take() {
    {
      auto free = free_.lock();
      if (!free->empty()) {
        auto stream = std::move(free->back());
        free->pop_back();
        return stream;
      }
    }
    return std::make_unique<GatherStream>();
  }
  void give_back(std::unique_ptr<GatherStream> stream) {
    auto free = free_.lock();
    if (free->size() < 8) free->push_back(std::move(stream));
  }

 private:
  base::Guarded<std::vector<std::unique_ptr<GatherStream>>, base::Rank::memory> free_;
};

// Shared by all ports of the process: memory only, no behaviour. Never destroyed, as threads may still send at the very end.
StreamPool& stream_pool() {
  static StreamPool& pool = *new StreamPool;
  return pool;
}

}  // namespace

Payload::Payload(const TypeOps& ops, const void* value) : ops_(ops), value_(value) {}

Payload::Payload(const TypeOps& ops, rt::Sample sample) : ops_(ops) {
  if (sample.value) {
    copy_ = std::move(sample.value);
    value_ = copy_.get();
    hash_ = sample.hash;
  } else {
    encoded_[static_cast<int>(sample.order)].block = std::move(sample.block);
  }
}

Payload::~Payload() {
  for (auto& encoded : encoded_) {
    if (encoded.stream) stream_pool().give_back(std::move(encoded.stream));
  }
}

const void* Payload::value() {
  if (value_) return value_;
  for (const auto order : {rt::ByteOrder::little, rt::ByteOrder::big}) {
    const auto& block = encoded_[static_cast<int>(order)].block;
    if (!block) continue;
    auto made = ops_.make();
    if (!decode(ops_, made.get(), block->octets(), order)) return nullptr;
    copy_ = std::move(made);
    value_ = copy_.get();
    return value_;
  }
  return nullptr;
}

const Pieces& Payload::pieces(rt::ByteOrder order) {
  Encoded& encoded = encoded_[static_cast<int>(order)];
  if (encoded.pieces) return *encoded.pieces;
  if (encoded.block) return encoded.pieces.emplace(Pieces{{encoded.block->octets()}, encoded.block->size()});
  const void* source = value();
  if (!source) throw CORBA::MARSHAL();
  if (ops_.codec) {
    encoded.block = ops_.codec->encode(source, order);
    if (!encoded.block) throw CORBA::MARSHAL();
    return encoded.pieces.emplace(Pieces{{encoded.block->octets()}, encoded.block->size()});
  }
  encoded.stream = stream_pool().take();
  encoded.stream->start(order, !ops_.has_wide_text);
  ops_.encode(source, *encoded.stream);
  return encoded.pieces.emplace(encoded.stream->pieces());
}

rt::Sample Payload::encoded(rt::ByteOrder order, rt::BlockPool& pool) {
  Encoded& encoded = encoded_[static_cast<int>(order)];
  if (!encoded.block) {
    const Pieces& all = pieces(order);
    auto block = pool.take(all.size);
    std::byte* to = block->data();
    for (const auto& part : all.parts) {
      std::memcpy(to, part.data(), part.size());
      to += part.size();
    }
    encoded.block = std::move(block);
  }
  rt::Sample sample;
  sample.block = encoded.block;
  sample.order = order;
  return sample;
}

rt::Sample Payload::copied() {
  if (!copy_) {
    if (const void* source = value(); source && !copy_) copy_ = ops_.copy(source);
  }
  rt::Sample sample;
  sample.value = copy_;
  sample.hash = hash_;
  return sample;
}

}  // namespace corba

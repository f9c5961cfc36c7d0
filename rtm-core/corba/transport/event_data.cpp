#include "corba/transport/event_data.h"

#include <algorithm>
#include <utility>

#include "corba/transport/cdr.h"
#include "corba/transport/payload.h"

namespace corba {

EventData::EventData(const TypeOps& ops, const void* value, rt::ByteOrder order) : ops_(&ops), original_(value), order_(order) {}

EventData::EventData(const TypeOps& ops, rt::Sample sample) : ops_(&ops), order_(sample.order), sample_(std::move(sample)) {}

EventData::EventData(Payload& payload, rt::ByteOrder order, rt::BlockPool& pool)
    : ops_(&payload.ops()), payload_(&payload), pool_(&pool), order_(order) {}

const Pieces* EventData::pieces() {
  try {
    return &payload_->pieces(order_);
  } catch (const CORBA::SystemException&) {
    return nullptr;  // the sender says so
  }
}

void* EventData::value() {
  if (value_) return value_.get();
  if (payload_) {
    const void* value = payload_->value();
    if (!value) return nullptr;
    value_ = ops_->copy(value);
    return value_.get();
  }
  if (original_) {
    value_ = ops_->copy(original_);
  } else if (sample_.value) {
    value_ = ops_->copy(sample_.value.get());
  } else {
    auto made = ops_->make();
    if (!sample_.block || !decode(*ops_, made.get(), sample_.block->octets(), order_)) return nullptr;
    value_ = std::move(made);
  }
  return value_.get();
}

void EventData::value_changed() {
  is_changed_ = true;
  payload_ = nullptr;
  sample_.block = nullptr;
  sample_.value = nullptr;
  sample_.hash.reset();
  original_ = value_ ? value_.get() : nullptr;
}

std::span<const std::byte> EventData::octets() {
  if (!sample_.block && payload_) {
    const Pieces* all = pieces();
    if (!all) return {};
    if (all->parts.size() == 1) return all->parts.front();
    sample_ = payload_->encoded(order_, *pool_);
  } else if (!sample_.block) {
    const void* source = original_ ? original_ : sample_.value ? sample_.value.get() : nullptr;
    if (!source) return {};
    try {
      sample_.block = encode(*ops_, source, order_);
    } catch (const CORBA::Exception&) {
      return {};
    }
  }
  return sample_.block->octets();
}

std::size_t EventData::size() {
  if (!payload_) return octets().size();
  const Pieces* all = pieces();
  return all ? all->size : 0;
}

void EventData::copy_octets(std::byte* to) {
  if (!payload_) {
    std::ranges::copy(octets(), to);
  } else if (const Pieces* all = pieces()) {
    for (const auto& part : all->parts) to = std::ranges::copy(part, to).out;
  }
}

void EventData::replace_octets(std::span<const std::byte> octets) {
  auto block = rt::BlockPool::make()->take(octets.size());
  std::ranges::copy(octets, block->data());
  is_changed_ = true;
  sample_.block = std::move(block);
  sample_.value = nullptr;
  sample_.hash.reset();
  payload_ = nullptr;
  original_ = nullptr;
  value_ = nullptr;
}

rt::Sample EventData::sample() {
  rt::Sample result = sample_;
  result.order = order_;
  if (!result.block && !result.value && original_) result.value = value_ && original_ == value_.get() ? value_ : ops_->copy(original_);
  return result;
}

}  // namespace corba

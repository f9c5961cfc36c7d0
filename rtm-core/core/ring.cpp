#include "core/ring.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace rt {

Ring::Ring(std::size_t length, std::size_t max_octets)
    : length_(length), max_octets_(max_octets), slots_(std::min<std::size_t>(length, 8)) {
  assert(length > 0);
}

void Ring::grow() {
  if (count_ < slots_.size() || slots_.size() == length_) return;
  std::rotate(slots_.begin(), slots_.begin() + static_cast<std::ptrdiff_t>(first_), slots_.end());
  first_ = 0;
  slots_.resize(std::min(length_, slots_.size() * 2));
}

bool Ring::push(Sample sample) {
  grow();
  const bool overwrites = is_full();
  if (overwrites) pop();
  octets_ += octets_of(sample);
  slots_[(first_ + count_) % slots_.size()] = std::move(sample);
  ++count_;
  return overwrites;
}

void Ring::push_front(Sample sample) {
  assert(!is_full());
  grow();
  first_ = (first_ + slots_.size() - 1) % slots_.size();
  octets_ += octets_of(sample);
  slots_[first_] = std::move(sample);
  ++count_;
}

Sample Ring::pop() {
  assert(!is_empty());
  Sample sample = std::exchange(slots_[first_], {});
  first_ = (first_ + 1) % slots_.size();
  --count_;
  octets_ -= octets_of(sample);
  return sample;
}

}  // namespace rt

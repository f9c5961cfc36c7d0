// The samples of one connection, oldest first, with a fixed number of slots and limited memory. One thread at a time.
#pragma once

#include <cstddef>
#include <vector>

#include "core/sample.h"

namespace rt {

class Ring {
 public:
  // length >= 1. Memory is taken as it is needed.
  explicit Ring(std::size_t length, std::size_t max_octets = max_octets_waiting);

  std::size_t length() const { return length_; }
  std::size_t size() const { return count_; }
  bool is_empty() const { return count_ == 0; }
  // One sample is taken however long it is.
  bool is_full() const { return count_ == length_ || (count_ > 0 && octets_ >= max_octets_); }
  std::size_t octets() const { return octets_; }

  // In a full ring the oldest sample makes room. True if one did.
  bool push(Sample sample);
  // Before the oldest; only if not full.
  void push_front(Sample sample);
  // The oldest; only if not empty.
  const Sample& front() const { return slots_[first_]; }
  Sample pop();

 private:
  void grow();

  std::size_t length_;
  std::size_t max_octets_;
  std::size_t octets_ = 0;  // octets_of all of them
  std::vector<Sample> slots_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace rt

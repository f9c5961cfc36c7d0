// The samples of one connection, oldest first, in a fixed number of places. One thread at a time.
#pragma once

#include <cstddef>
#include <vector>

#include "core/sample.h"

namespace rt {

class Ring {
 public:
  // length >= 1. Memory is taken as it is needed.
  explicit Ring(std::size_t length);

  std::size_t length() const { return length_; }
  std::size_t size() const { return count_; }
  bool is_empty() const { return count_ == 0; }
  bool is_full() const { return count_ == length_; }

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
  std::vector<Sample> slots_;
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace rt

// The samples that wait to be sent on one connection, and their order. One thread at a time.
#pragma once

#include <vector>

#include "core/connector_settings.h"
#include "core/ring.h"

namespace rt {

class SendQueue {
 public:
  SendQueue(std::size_t length, const PublisherSettings& settings) : ring_(length), settings_(settings) {}

  bool is_empty() const { return ring_.is_empty(); }
  bool is_full() const { return ring_.is_full(); }
  std::size_t size() const { return ring_.size(); }
  Sample pop() { return ring_.pop(); }
  // True if an unsent sample was lost.
  bool push(Sample sample) { return ring_.push(std::move(sample)); }

  // Takes out what the policy sends now, oldest first; what it skips is dropped. all: everything; fifo: the oldest; skip: every
  // (skip_count + 1)th, counted from the first sample of the connection; newest: the last.
  std::vector<Sample> next_batch();
  // Samples that could not be sent wait again, before everything else, as far as there is room; the oldest go first.
  void put_back(std::vector<Sample> samples);

 private:
  Ring ring_;
  PublisherSettings settings_;
  std::size_t skipped_ = 0;  // since the last one that was sent
};

}  // namespace rt

#include "core/send_queue.h"

#include <utility>

namespace rt {

std::vector<Sample> SendQueue::next_batch() {
  std::vector<Sample> batch;
  while (!ring_.is_empty()) {
    Sample sample = ring_.pop();
    switch (settings_.policy) {
      case PushPolicy::all:
        batch.push_back(std::move(sample));
        break;
      case PushPolicy::fifo:
        batch.push_back(std::move(sample));
        return batch;
      case PushPolicy::skip:
        if (skipped_ < settings_.skip_count) {
          ++skipped_;
        } else {
          skipped_ = 0;
          batch.push_back(std::move(sample));
        }
        break;
      case PushPolicy::newest:
        if (ring_.is_empty()) batch.push_back(std::move(sample));
        break;
    }
  }
  return batch;
}

void SendQueue::put_back(std::vector<Sample> samples) {
  // A newer sample has come meanwhile: that is the one to send.
  if (settings_.policy == PushPolicy::newest && !ring_.is_empty()) return;
  while (!samples.empty() && !ring_.is_full()) {
    ring_.push_front(std::move(samples.back()));
    samples.pop_back();
  }
}

}  // namespace rt

#include "sample_filters.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace recorder {

namespace {

constexpr std::size_t most_octets = 512 << 20;

std::size_t size_of(const channels::Sample& sample) { return sample.octets.size() + sizeof(channels::Sample); }

}  // namespace

RateSink::RateSink(std::shared_ptr<channels::Sink> to, double rate)
    : to_(std::move(to)), period_(std::max<std::int64_t>(1, std::llround(1e9 / rate))) {}

// The first one in each period; those that are left out are not missing.
base::Result<void> RateSink::take(const channels::Sample& sample) {
  const std::int64_t period = sample.log_time / period_;
  const auto last = last_.find(sample.channel);
  if (last != last_.end() && last->second == period) return {};
  last_[sample.channel] = period;
  channels::Sample kept = sample;
  kept.sequence = sequences_[sample.channel]++;
  return to_->take(kept);
}

base::Result<void> LastSink::open(channels::ChannelId id, const channels::Channel& channel) {
  if (channel.topic == "/tf_static") static_frames_ = id;
  return to_->open(id, channel);
}

void LastSink::drop_front() {
  octets_ -= size_of(samples_.front());
  samples_.pop_front();
}

base::Result<void> LastSink::take(const channels::Sample& sample) {
  if (sample.channel == static_frames_) {
    static_sample_ = sample;
    return {};
  }
  octets_ += size_of(sample);
  samples_.push_back(sample);
  while (samples_.front().log_time < sample.log_time - span_ || octets_ > most_octets) drop_front();
  return {};
}

base::Result<void> LastSink::hand_on() {
  if (static_sample_ && !samples_.empty()) {
    static_sample_->log_time = samples_.front().log_time;
    if (const auto done = to_->take(*static_sample_); !done) return done;
  }
  for (const auto& sample : samples_) {
    if (const auto done = to_->take(sample); !done) return done;
  }
  samples_.clear();
  octets_ = 0;
  return {};
}

}  // namespace recorder

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

base::Result<void> RateSink::open(channels::ChannelId id, const channels::Channel& channel) {
  if (channel.is_latched()) latched_.insert(id);
  return to_->open(id, channel);
}

// The first one in each period; those that are left out are not missing.
base::Result<void> RateSink::take(const channels::Sample& sample) {
  if (latched_.contains(sample.channel)) return to_->take(sample);
  const std::int64_t period = sample.log_time / period_;
  const auto last = last_.find(sample.channel);
  if (last != last_.end() && last->second == period) return {};
  last_[sample.channel] = period;
  channels::Sample kept = sample;
  kept.sequence = sequences_[sample.channel]++;
  return to_->take(kept);
}

base::Result<void> LastSink::open(channels::ChannelId id, const channels::Channel& channel) {
  if (channel.is_latched()) latched_.try_emplace(id);
  return to_->open(id, channel);
}

// What held before the time that is kept still holds in it.
void LastSink::drop_front() {
  auto& front = samples_.front();
  octets_ -= size_of(front);
  if (const auto held = latched_.find(front.channel); held != latched_.end()) held->second = std::move(front);
  samples_.pop_front();
}

base::Result<void> LastSink::take(const channels::Sample& sample) {
  octets_ += size_of(sample);
  samples_.push_back(copy_of(sample));
  while (samples_.front().log_time < sample.log_time - span_ || octets_ > most_octets) drop_front();
  return {};
}

base::Result<void> LastSink::hand_on() {
  for (auto& [id, held] : latched_) {
    if (!held || samples_.empty()) continue;
    held->log_time = samples_.front().log_time;
    if (const auto done = to_->take(*held); !done) return done;
  }
  for (const auto& sample : samples_) {
    if (const auto done = to_->take(sample); !done) return done;
  }
  samples_.clear();
  octets_ = 0;
  return {};
}

}  // namespace recorder

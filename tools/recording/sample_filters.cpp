#include "recording/sample_filters.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace recorder {

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

}  // namespace recorder

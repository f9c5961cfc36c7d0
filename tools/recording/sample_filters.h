// Sinks that forward a part of the samples: a maximum rate, the last seconds. Called on one thread at a time, as every sink.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <set>

#include "channels/exchange.h"

namespace recorder {

// So many samples of each channel in a second of their own clock, at most.
class RateSink final : public channels::Sink {
 public:
  RateSink(std::shared_ptr<channels::Sink> to, double rate);
  base::Result<void> open(channels::ChannelId id, const channels::Channel& channel) override;
  base::Result<void> take(const channels::Sample& sample) override;
  base::Result<void> close(channels::ChannelId id) override { return to_->close(id); }
  base::Result<void> rest() override { return to_->rest(); }

 private:
  const std::shared_ptr<channels::Sink> to_;
  const std::chrono::nanoseconds period_;
  std::map<channels::ChannelId, std::int64_t> last_;  // the period in which the last one was
  std::map<channels::ChannelId, std::uint32_t> sequences_;
  std::set<channels::ChannelId> latched_;  // of which all are handed on
};

}  // namespace recorder

// Sinks that hand on a part of what they get: fewer samples, or the last ones. Called on one thread at a time, as every sink.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "exchange.h"

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

// Keeps the last seconds of all channels, and hands them on when it is told to. Of latched channels the sample
// stays that held at their beginning. At most 512 MiB: of more than that the oldest go.
class LastSink final : public channels::Sink {
 public:
  LastSink(std::shared_ptr<channels::Sink> to, std::chrono::nanoseconds span) : to_(std::move(to)), span_(span) {}
  base::Result<void> open(channels::ChannelId id, const channels::Channel& channel) override;
  base::Result<void> take(const channels::Sample& sample) override;
  // After the exchange has ended.
  base::Result<void> hand_on();

 private:
  void drop_front();

  const std::shared_ptr<channels::Sink> to_;
  const std::chrono::nanoseconds span_;
  std::deque<channels::Sample> samples_;
  std::size_t octets_ = 0;
  std::map<channels::ChannelId, std::optional<channels::Sample>> latched_;
};

}  // namespace recorder

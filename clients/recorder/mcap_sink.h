// Channels into an MCAP file. Called on one thread at a time, as every sink. What came more than a second ago is in the file, whatever
// happens to the process.
#pragma once

#include <chrono>
#include <map>
#include <string>

#include "exchange.h"
#include "mcap/mcap.h"

namespace recorder {

class McapSink final : public channels::Sink {
 public:
  explicit McapSink(mcap::Writer writer) : writer_(std::move(writer)) {}

  base::Result<void> open(channels::ChannelId id, const channels::Channel& channel) override;
  base::Result<void> take(const channels::Sample& sample) override;
  base::Result<void> rest() override;
  // After the exchange has ended.
  mcap::Writer& writer() { return writer_; }

 private:
  mcap::Writer writer_;
  std::map<channels::ChannelId, std::uint16_t> ids_;                      // in the file
  std::map<std::pair<std::string, std::string>, std::uint16_t> schemas_;  // by name and text
  std::chrono::steady_clock::time_point flushed_ = std::chrono::steady_clock::now();
};

}  // namespace recorder

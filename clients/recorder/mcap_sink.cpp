#include "mcap_sink.h"

#include <algorithm>
#include <utility>

namespace recorder {

namespace {

constexpr std::chrono::milliseconds flush_period{500};  // what a kill may cost, with the time that a rest may take

}  // namespace

base::Result<void> McapSink::open(channels::ChannelId id, const channels::Channel& channel) {
  const auto& schema = channel.schema;
  auto& known = schemas_[{schema.name, schema.text}];
  if (known == 0 && !schema.name.empty()) {
    const auto added = writer_.add_schema(schema.name, schema.encoding, schema.text);
    if (!added) return added.error();
    known = *added;
  }
  const auto added = writer_.add_channel(known, channel.topic, channel.encoding, channel.metadata);
  if (!added) return added.error();
  ids_[id] = *added;
  return {};
}

base::Result<void> McapSink::take(const channels::Sample& sample) {
  const auto time = [](channels::Time one) { return mcap::Time(static_cast<std::uint64_t>(std::max<std::int64_t>(one.count(), 0))); };
  const auto done = writer_.write({ids_[sample.channel],
                                   sample.sequence,
                                   time(sample.log_time),
                                   time(sample.publish_time),
                                   {sample.octets.data(), sample.octets.size()}});
  return done ? rest() : done;
}

base::Result<void> McapSink::rest() {
  const auto now = std::chrono::steady_clock::now();
  if (now - flushed_ < flush_period) return {};
  flushed_ = now;
  return writer_.flush();
}

}  // namespace recorder

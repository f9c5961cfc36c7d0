#include "recording/mcap_sink.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "base/text.h"
#include "recording/ring.h"

namespace recorder {

namespace {

constexpr std::chrono::milliseconds flush_period{500};  // what a kill may cost, with the time that a rest may take

constexpr std::chrono::seconds least_reset{1};  // back in time; less than that is a sample that came late

}  // namespace

base::Result<Split> parse_split(const std::string& text) {
  const auto wrong =
      base::Error{"split " + base::in_quotes(text) + ": expected bytes such as 64k, 500M or 2G, or a duration such as 30s, 10m or 1h"};
  if (text.empty()) return wrong;
  if (const auto seconds = base::parse_seconds(text); seconds && !base::parse_number(text)) {
    if (!(*seconds > 0)) return wrong;
    return Split{.time = std::chrono::nanoseconds(std::llround(std::min(*seconds, 1e9) * 1e9))};
  }
  const auto number = base::parse_number(text.substr(0, text.size() - 1));
  if (!number || !(*number > 0) || *number > 1e9) return wrong;
  switch (text.back()) {
    case 'k':
      return Split{.octets = static_cast<std::uint64_t>(std::ceil(*number * 1024))};
    case 'M':
      return Split{.octets = static_cast<std::uint64_t>(std::ceil(*number * 1024 * 1024))};
    case 'G':
      return Split{.octets = static_cast<std::uint64_t>(std::ceil(*number * 1024 * 1024 * 1024))};
    default:
      return wrong;
  }
}

base::Result<std::shared_ptr<McapSink>> McapSink::create(const std::string& path, const Split& split, NewFile make) {
  std::shared_ptr<McapSink> sink(new McapSink(path, split, std::move(make)));
  if (const auto begun = sink->begin_file({}); !begun) return begun.error();
  return sink;
}

// What holds already stands in it, too: it can be read alone.
base::Result<void> McapSink::begin_file(channels::Time begun) {
  if (writer_) {
    samples_ += writer_->statistics().messages;
    if (const auto closed = writer_->close(); !closed) return closed;
  }
  ++files_;
  // The one before spans all that a ring keeps.
  if (split_.is_ring && files_ > 2) std::remove(numbered_path(path_, files_ - 2).c_str());
  const std::string path = split_.is_one() ? path_ : numbered_path(path_, files_);
  auto writer = make_(path);
  if (!writer && split_.is_ring) std::remove(path.c_str());  // what has no metadata yet is no segment
  if (!writer) return writer.error();
  writer_.emplace(std::move(*writer));
  if (split_.is_ring) {
    if (const auto added = writer_->add_metadata(ring_metadata({"", files_, resets_, split_.time, split_.compression})); !added)
      return added;
  }
  ids_.assign(ids_.size(), 0);
  schemas_.clear();
  first_.reset();
  for (const auto& [id, channel] : channels_) {
    if (const auto added = add(id, channel); !added) return added;
  }
  for (auto& [id, sample] : latched_) {
    sample.log_time = std::max(sample.log_time, begun);
    if (const auto written = write(sample); !written) return written;
  }
  if (!latched_.empty()) {
    if (const auto flushed = writer_->flush(); !flushed) return flushed;
  }
  begun_with_ = writer_->size();
  chunk_begun_ = begun;
  return {};
}

// A file has at least as much of its own as what every one begins with.
bool McapSink::is_full(const channels::Sample& sample) const {
  if (split_.octets > 0 && writer_->size() >= std::max(split_.octets, 2 * begun_with_)) return true;
  return split_.time.count() > 0 && first_ && sample.log_time - *first_ >= split_.time;
}

// Simulated time has begun again. What is known only behind the run (hashes) says nothing of time.
bool McapSink::has_reset(const channels::Sample& sample) const {
  if (!split_.is_ring || sample.log_time >= latest_ - std::max<channels::Time>(split_.time, least_reset)) return false;
  const auto channel = channels_.find(sample.channel);
  return channel == channels_.end() || !channel->second.metadata.contains("late");
}

base::Result<void> McapSink::add(channels::ChannelId id, const channels::Channel& channel) {
  const auto& schema = channel.schema;
  auto& known = schemas_[{schema.name, schema.text}];
  if (known == 0 && !schema.name.empty()) {
    const auto added = writer_->add_schema(schema.name, schema.encoding, schema.text);
    if (!added) return added.error();
    known = *added;
  }
  const auto added = writer_->add_channel(known, channel.topic, channel.encoding, channel.metadata);
  if (!added) return added.error();
  if (ids_.size() <= id) ids_.resize(id + std::size_t{1});
  ids_[id] = *added;
  return {};
}

base::Result<void> McapSink::open(channels::ChannelId id, const channels::Channel& channel) {
  if (!split_.is_one()) channels_.emplace(id, channel);
  return add(id, channel);
}

base::Result<void> McapSink::take(const channels::Sample& sample) {
  if (has_reset(sample)) {
    ++resets_;
    latest_ = channels::Time(0);
    for (auto& [id, held] : latched_) held.log_time = sample.log_time;
    if (const auto begun = begin_file(sample.log_time); !begun) return begun;
  } else if (is_full(sample)) {
    if (const auto begun = begin_file(sample.log_time); !begun) return begun;
  }
  // A run that is faster than real time loses no more of its own last second.
  if (split_.is_ring && sample.log_time - chunk_begun_ >= flush_period) {
    chunk_begun_ = sample.log_time;
    if (const auto flushed = writer_->flush(); !flushed) return flushed;
  }
  if (!first_) first_ = sample.log_time;
  latest_ = std::max(latest_, sample.log_time);
  if (const auto channel = channels_.find(sample.channel); channel != channels_.end() && channel->second.is_latched())
    latched_.insert_or_assign(sample.channel, copy_of(sample));
  return write(sample);
}

base::Result<void> McapSink::write(const channels::Sample& sample) {
  const auto time = [](channels::Time one) { return mcap::Time(static_cast<std::uint64_t>(std::max<std::int64_t>(one.count(), 0))); };
  return writer_->write({ids_[sample.channel],
                         sample.sequence,
                         time(sample.log_time),
                         time(sample.publish_time),
                         {sample.octets.data(), sample.octets.size()}});
}

base::Result<void> McapSink::rest() {
  const auto now = std::chrono::steady_clock::now();
  if (now - flushed_ < flush_period) return {};
  flushed_ = now;
  return writer_->flush();
}

base::Result<void> McapSink::close() { return writer_->close(); }

}  // namespace recorder

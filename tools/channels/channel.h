// Data of a running system as named channels: a source opens a channel with its schema and puts samples into it, sinks receive them. It
// uses no files and no sockets. Values.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace channels {

// Since time 0 of the simulation; without a simulator since 1970 (UTC).
using Time = std::chrono::nanoseconds;

struct Schema {
  std::string name;      // "RTC::TimedLong", "sensor_msgs/msg/LaserScan"
  std::string encoding;  // "omgidl", "ros2msg", "jsonschema"; empty: none
  std::string text;      // complete: it needs no other
  bool operator==(const Schema&) const = default;
};

struct Channel {
  std::string topic;     // "/MyComponent0/out"
  std::string encoding;  // of the samples: "cdr" (four octets say the byte order, then plain CDR), "json"
  Schema schema;
  std::map<std::string, std::string> metadata;

  // Its latest sample holds until there is another one (the metadata have `latched`): a sink that keeps a part keeps that one, too.
  bool is_latched() const { return metadata.contains("latched"); }
};

using ChannelId = std::uint16_t;

struct Sample {
  ChannelId channel = 0;
  std::uint32_t sequence = 0;  // of the channel, from 0; a gap is what was dropped
  Time log_time{0};            // when it was said, by the clock of the simulation
  Time publish_time{0};        // the same by the wall clock
  std::span<const char> octets;
  std::shared_ptr<const void> owner;  // of the octets: a copy of the sample keeps them, and those that were put together with it
};

// With octets of its own, for those who keep it for long.
Sample copy_of(const Sample& sample);

// The four octets before the plain CDR of a sample.
std::string_view cdr_head(bool is_little_endian);

}  // namespace channels

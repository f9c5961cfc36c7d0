// The summary at the end of an MCAP file. A value.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "recording/mcap/bytes.h"

namespace mcap {

struct Summary {
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  Statistics statistics;
  std::vector<ChunkEntry> chunks;  // in the order of the file
  std::vector<AttachmentPlace> attachments;
  std::vector<MetadataPlace> metadata;
};

// `of_channel`: the channel's place in statistics.messages_of.
void count(Statistics& statistics, const Message& message, std::uint64_t& of_channel);

// All that follows the data: the end of the data, the summary with its offsets, the footer. `start`: octets before it; `crc`: of these.
std::string end_of_file(const Summary& summary, std::uint64_t start, std::uint32_t crc);

}  // namespace mcap

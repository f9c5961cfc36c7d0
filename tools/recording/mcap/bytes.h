// Encodes and decodes little-endian numbers, texts and records of MCAP. Values; any thread.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "recording/mcap/mcap.h"

namespace mcap {

inline constexpr std::string_view magic{"\x89MCAP0\r\n", 8};
inline constexpr std::string_view own_library = "rtm-sim";  // in the header of files that our writer made
inline constexpr std::size_t record_head = 9;               // [bytes] opcode and length
inline constexpr std::size_t message_head = 22;             // [bytes] of a message's content before its data
inline constexpr std::size_t footer_record = record_head + 20;

enum class Opcode : std::uint8_t {
  header = 1,
  footer = 2,
  schema = 3,
  channel = 4,
  message = 5,
  chunk = 6,
  message_index = 7,
  chunk_index = 8,
  attachment = 9,
  attachment_index = 10,
  statistics = 11,
  metadata = 12,
  metadata_index = 13,
  summary_offset = 14,
  data_end = 15,
};

// The format is little-endian, as is every machine that rtm-sim runs on.
template <class Number>
void put(std::string& out, Number number) {
  char octets[sizeof number];
  std::memcpy(octets, &number, sizeof number);
  out.append(octets, sizeof number);
}
inline void put(std::string& out, Time time) { put(out, time.count()); }
inline void put_text(std::string& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out.append(text);
}
void put_texts(std::string& out, const Texts& texts);
void put_record(std::string& out, Opcode opcode, std::string_view content);

// Reads a content front to back. What goes beyond its end gives zeros and nothing, and ok() is false from then on.
class Octets {
 public:
  explicit Octets(std::string_view rest) : rest_(rest) {}

  template <class Number>
  Number number() {
    Number value{};
    const std::string_view octets = take(sizeof value);
    if (!octets.empty()) std::memcpy(&value, octets.data(), sizeof value);
    return value;
  }
  Time time() { return Time(number<std::uint64_t>()); }
  std::string_view text() { return take(number<std::uint32_t>()); }
  std::string_view long_text() { return take(number<std::uint64_t>()); }
  Texts texts();
  // The next `size` octets as a content of their own.
  Octets part(std::uint64_t size) { return Octets(take(size)); }
  std::string_view rest() const { return rest_; }
  bool is_empty() const { return rest_.empty(); }
  bool ok() const { return ok_; }

 private:
  std::string_view take(std::uint64_t size) {
    if (size > rest_.size()) {
      ok_ = false;
      rest_ = {};
      return {};
    }
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }

  std::string_view rest_;
  bool ok_ = true;
};

void put_schema(std::string& out, const Schema& schema);
void put_channel(std::string& out, const Channel& channel);
// Nothing when the content is not whole.
std::optional<Schema> take_schema(std::string_view content);
std::optional<Channel> take_channel(std::string_view content);
std::optional<Message> take_message(std::string_view content);

// The channels of a chunk, as runs of consecutive IDs: most chunks of a recording have nearly all channels.
class ChannelSet {
 public:
  ChannelSet() = default;
  explicit ChannelSet(std::vector<std::uint16_t> channels);

  bool is_empty() const { return runs_.empty(); }
  bool contains(std::uint16_t channel) const;
  void add_to(std::vector<bool>& all) const;  // by ID; grows as needed

 private:
  std::vector<std::pair<std::uint16_t, std::uint16_t>> runs_;  // first and last, in their order
};

// A record of the summary that says where a chunk is.
struct ChunkEntry {
  Time first{0};
  Time last{0};
  std::uint64_t start = 0;                                             // [bytes] of its record in the file
  std::uint64_t length = 0;                                            // [bytes] with opcode and length
  std::vector<std::pair<std::uint16_t, std::uint64_t>> index_offsets;  // by channel; needed only to write the record
  std::uint64_t index_length = 0;                                      // [bytes]
  std::string compression;
  std::uint64_t compressed = 0;    // [bytes]
  std::uint64_t uncompressed = 0;  // [bytes]
  ChannelSet channels;             // of its messages; empty: not known. Not part of the record
};
void put_chunk_index(std::string& out, const ChunkEntry& entry);
std::optional<ChunkEntry> take_chunk_index(std::string_view content);

// The content of a chunk's record.
struct ChunkHead {
  Time first{0};
  Time last{0};
  std::uint64_t uncompressed = 0;
  std::uint32_t crc = 0;  // 0: none
  std::string_view compression;
  std::string_view records;  // compressed
};
std::optional<ChunkHead> take_chunk(std::string_view content);

struct AttachmentPlace {
  std::uint64_t start = 0;
  std::uint64_t length = 0;
  Time log_time{0};
  Time create_time{0};
  std::uint64_t size = 0;
  std::string name;
  std::string media_type;
};
void put_attachment_index(std::string& out, const AttachmentPlace& place);
std::optional<AttachmentPlace> take_attachment_index(std::string_view content);

struct MetadataPlace {
  std::uint64_t start = 0;
  std::uint64_t length = 0;
  std::string name;
};
void put_metadata_index(std::string& out, const MetadataPlace& place);
std::optional<MetadataPlace> take_metadata_index(std::string_view content);

void put_statistics(std::string& out, const Statistics& statistics);
std::optional<Statistics> take_statistics(std::string_view content);

}  // namespace mcap

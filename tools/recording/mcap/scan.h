// The index of an MCAP file: from the summary at its end or, without one, from a scan of all records. Lengths and offsets are checked
// against the size of the file. Values; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "recording/mcap/file.h"
#include "recording/mcap/records.h"
#include "recording/mcap/summary.h"

namespace mcap {

// A message outside of chunks.
struct LooseMessage {
  Time time{0};
  std::uint64_t offset = 0;  // [bytes] of its record
  std::uint64_t length = 0;  // [bytes] of its content
};

// Records of a scanned file that cannot be read.
struct Broken {
  std::uint64_t chunks = 0;
  std::uint64_t attachments = 0;
  std::uint64_t metadata = 0;
  std::uint64_t others = 0;    // not part of the data
  std::uint64_t octets = 0;    // of all of them
  std::uint64_t messages = 0;  // in the chunks, according to the indexes behind them
  bool are_counted = true;     // each chunk has an index, so that no message is missing in the number
};

// An index can keep the offsets of message indexes, which only a repair needs. They take 16 bytes for each channel of each chunk: 200
// MB for ten minutes of 2000 channels.
enum class Offsets { left_out, kept };

struct Index {
  std::string profile;
  std::string library;
  Summary summary;
  std::vector<LooseMessage> loose;  // in the order of the file
  std::optional<std::string> damage;
  std::uint64_t data_end = 0;  // [bytes] where the last whole record of the data ends
  bool has_data_end = false;   // a record marks it: no data follow
  Broken broken;
  std::uint64_t cut_off = 0;  // [bytes] behind the last whole record, if no record marks the end of the data
};

// Maximum of schemas and channels together [bytes]; all of them are kept in memory.
inline constexpr std::uint64_t max_descriptions = 16ull << 20;

// The index has no offsets.
base::Result<Index> read_index(const File& file);
// Reads the summary alone. Nothing if there is none, or if it lacks records; `damage` names what is damaged and not only missing. The index
// has no offsets.
base::Result<std::optional<Index>> read_summary(const File& file, std::uint64_t size, std::optional<std::string>& damage);
// Reads all records, and ignores the summary. Chunks are decompressed and checked.
base::Result<Index> scan(const File& file, Offsets offsets);

}  // namespace mcap

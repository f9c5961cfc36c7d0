// What a reader knows of a file before it reads messages: from the summary at its end or, without one, from a walk over all its records.
// Whatever a file says of lengths and offsets is checked against its size before it is believed. Values; any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mcap/file.h"
#include "mcap/summary.h"

namespace mcap {

// A message that stands outside of chunks.
struct LooseMessage {
  Time time{0};
  std::uint64_t offset = 0;  // [octets] of its record
  std::uint64_t length = 0;  // [octets] of its content
};

// Chunks that cannot be read, of a file that was walked over.
struct BrokenChunks {
  std::uint64_t count = 0;
  std::uint64_t octets = 0;    // of their records
  std::uint64_t messages = 0;  // as far as the indexes behind them say
  bool are_counted = true;     // each has an index, so that no message is missing in the number
};

struct Index {
  std::string profile;
  std::string library;
  Summary summary;
  std::vector<LooseMessage> loose;  // in the order of the file
  std::optional<std::string> damage;
  std::uint64_t data_end = 0;  // [octets] where the last whole record of the data ends
  bool has_data_end = false;   // and a record says so: what follows is no data
  BrokenChunks broken;
};

// Schemas and channels together [octets]; more is refused, since every one of them is kept in memory.
inline constexpr std::uint64_t most_descriptions = 16ull << 20;

base::Result<Index> read_index(const File& file);
// Walks over all records, whatever the summary says. Chunks are decompressed and checked.
base::Result<Index> scan(const File& file);

// The records of a chunk, decompressed and checked. An error names the file and the octet.
base::Result<void> read_chunk(const File& file, std::uint64_t offset, std::uint64_t length, std::string& records);

// Calls `take` with each record of a chunk's octets and the offset of its content; an error when the last one is cut off.
base::Result<void> for_each_record(std::string_view records,
                                   const std::function<void(Opcode opcode, std::string_view content, std::uint64_t offset)>& take);

}  // namespace mcap

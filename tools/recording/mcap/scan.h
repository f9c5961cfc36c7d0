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

// A message that stands outside of chunks.
struct LooseMessage {
  Time time{0};
  std::uint64_t offset = 0;  // [octets] of its record
  std::uint64_t length = 0;  // [octets] of its content
};

// Records that cannot be read, of a file that was walked over.
struct Broken {
  std::uint64_t chunks = 0;
  std::uint64_t attachments = 0;
  std::uint64_t metadata = 0;
  std::uint64_t others = 0;    // of a kind that is none of the data
  std::uint64_t octets = 0;    // of all of them
  std::uint64_t messages = 0;  // in the chunks, as far as the indexes behind them say
  bool are_counted = true;     // each chunk has an index, so that no message is missing in the number
};

// Whether an index keeps the offsets of message indexes, which only a repair needs. They take 16 bytes for each channel of each chunk: 200
// MB for ten minutes of 2000 channels.
enum class Offsets { left_out, kept };

struct Index {
  std::string profile;
  std::string library;
  Summary summary;
  std::vector<LooseMessage> loose;  // in the order of the file
  std::optional<std::string> damage;
  std::uint64_t data_end = 0;  // [octets] where the last whole record of the data ends
  bool has_data_end = false;   // and a record says so: what follows is no data
  Broken broken;
  std::uint64_t cut_off = 0;  // [octets] behind the last whole record, where no record says that the data end
};

// Schemas and channels together [octets]; more is refused, since every one of them is kept in memory.
inline constexpr std::uint64_t most_descriptions = 16ull << 20;

// Without offsets.
base::Result<Index> read_index(const File& file);
// By the summary alone. Nothing when there is none, or one that does not say enough; `damage` tells what is broken rather than left out.
// Without offsets.
base::Result<std::optional<Index>> read_summary(const File& file, std::uint64_t size, std::optional<std::string>& damage);
// Walks over all records, whatever the summary says. Chunks are decompressed and checked.
base::Result<Index> scan(const File& file, Offsets offsets);

}  // namespace mcap

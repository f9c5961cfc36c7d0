// The records of an MCAP file. Lengths are checked before they are used. Any thread.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "recording/mcap/bytes.h"
#include "recording/mcap/file.h"

namespace mcap {

// One line that names the file and the octet.
base::Error at(const File& file, std::uint64_t offset, const std::string& what);

struct RecordHead {
  Opcode opcode{};
  std::uint64_t length = 0;  // [bytes] of its content
};

// Nothing when the record does not lie whole before `end`.
base::Result<std::optional<RecordHead>> read_head(const File& file, std::uint64_t offset, std::uint64_t end);
// Of the first octets of a record; nothing when it is longer than `room`, its head included [bytes].
std::optional<RecordHead> to_head(std::string_view octets, std::uint64_t room);

// The records of a chunk, decompressed and checked. An error names the file and the octet.
base::Result<void> read_chunk(const File& file, std::uint64_t offset, std::uint64_t length, std::string& records);

// Calls `take` with each record of a chunk's octets and the offset of its content; an error when the last one is cut off.
base::Result<void> for_each_record(std::string_view records,
                                   const std::function<void(Opcode opcode, std::string_view content, std::uint64_t offset)>& take);

}  // namespace mcap

#include "recording/mcap/records.h"

#include "base/text.h"
#include "recording/mcap/compression.h"

namespace mcap {

base::Error at(const File& file, std::uint64_t offset, const std::string& what) {
  return {base::in_quotes(file.path()) + ": octet " + std::to_string(offset) + ": " + what};
}

base::Result<std::optional<RecordHead>> read_head(const File& file, std::uint64_t offset, std::uint64_t end) {
  if (offset > end || end - offset < record_head) return std::optional<RecordHead>();
  std::string octets;
  if (const auto done = file.read(offset, record_head, octets); !done) return done.error();
  return to_head(octets, end - offset);
}

std::optional<RecordHead> to_head(std::string_view octets, std::uint64_t room) {
  Octets in(octets);
  RecordHead head;
  head.opcode = static_cast<Opcode>(in.number<std::uint8_t>());
  head.length = in.number<std::uint64_t>();
  if (room < record_head || head.length > room - record_head) return std::nullopt;
  return head;
}

base::Result<void> for_each_record(std::string_view records, const std::function<void(Opcode, std::string_view, std::uint64_t)>& take) {
  std::uint64_t offset = 0;
  while (offset < records.size()) {
    Octets in(records.substr(offset));
    if (in.rest() == magic) return {};  // the end of the file behind its footer
    const auto opcode = static_cast<Opcode>(in.number<std::uint8_t>());
    const auto length = in.number<std::uint64_t>();
    if (!in.ok() || length > in.rest().size()) return base::Error{"the record at octet " + std::to_string(offset) + " is cut off"};
    take(opcode, in.rest().substr(0, length), offset + record_head);
    offset += record_head + length;
  }
  return {};
}

base::Result<void> read_chunk(const File& file, std::uint64_t offset, std::uint64_t length, std::string& records) {
  std::string octets;
  if (length < record_head) return at(file, offset, "the chunk is shorter than any is");
  if (const auto done = file.read(offset, length, octets); !done) return done;
  Octets in(octets);
  const auto opcode = static_cast<Opcode>(in.number<std::uint8_t>());
  const auto size = in.number<std::uint64_t>();
  const auto chunk = take_chunk(in.rest());
  // Where the summary says that a chunk is, its own CRC is worth more than the octets before it.
  const bool is_sure = (opcode == Opcode::chunk && size == in.rest().size()) || (chunk && chunk->crc != 0);
  if (!chunk || !is_sure) return at(file, offset, "expected a chunk of " + std::to_string(length) + " bytes");
  if (chunk->uncompressed > Reader::largest_chunk) {
    return at(file, offset,
              "the chunk announces " + std::to_string(chunk->uncompressed) + " bytes; at most " + std::to_string(Reader::largest_chunk) +
                  " are read");
  }
  if (const auto done = decompress(chunk->compression, chunk->records, chunk->uncompressed, records); !done) {
    return at(file, offset, "the chunk " + done.error().message);
  }
  if (chunk->crc != 0 && crc32(0, records) != chunk->crc) return at(file, offset, "the chunk's data do not match their CRC");
  return {};
}

}  // namespace mcap

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "base/text.h"
#include "mcap/compression.h"
#include "mcap/scan.h"

namespace mcap {

namespace {

constexpr std::uint64_t piece_size = 1 << 20;  // [octets]

}  // namespace

// The octets of the data stay as they are, whoever wrote them; what follows the last whole record is replaced by a summary,
// which does not name broken chunks.
base::Result<Repair> repair(const std::string& from, const std::string& to) {
  auto file = File::open(from);
  if (!file) return file.error();
  const auto size = file->size();
  if (!size) return size.error();
  auto index = scan(*file);
  if (!index) return index.error();

  if (const auto good = File::check_name(to); !good) return good.error();  // a rename would put a file in the place of a device
  const std::string whole = to + ".part";
  auto out = File::create(whole);
  if (!out) return out.error();
  const auto give_up = [&](const base::Error& error) {
    std::remove(whole.c_str());
    return error;
  };
  std::uint32_t crc = 0;
  std::string piece;
  for (std::uint64_t offset = 0; offset < index->data_end; offset += piece.size()) {
    if (const auto done = file->read(offset, std::min(piece_size, index->data_end - offset), piece); !done) return give_up(done.error());
    crc = crc32(crc, piece);
    if (const auto done = out->append(piece); !done) return give_up(done.error());
  }
  for (ChunkEntry& chunk : index->summary.chunks) {
    std::erase_if(chunk.index_offsets, [](const auto& entry) { return entry.second == 0; });  // channels whose index the file lost
    if (chunk.index_length == 0) chunk.index_offsets.clear();
  }
  if (const auto done = out->append(end_of_file(index->summary, index->data_end, crc)); !done) return give_up(done.error());
  if (std::rename(whole.c_str(), to.c_str()) != 0) {
    return give_up({base::in_quotes(to) + ": cannot be written: " + std::strerror(errno)});
  }
  const BrokenChunks& broken = index->broken;
  const std::uint64_t behind = index->has_data_end ? 0 : *size - index->data_end;
  return Repair{index->summary.statistics.messages, behind + broken.octets, broken.count,
                broken.are_counted ? std::optional(broken.messages) : std::nullopt, index->damage};
}

}  // namespace mcap

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <map>

#include "base/text.h"
#include "recording/mcap/compression.h"
#include "recording/mcap/scan.h"

namespace mcap {

namespace {

constexpr std::uint64_t piece_size = 1 << 20;  // [bytes]

void note(Repair& repair, const base::Error& error) {
  if (!repair.damage) repair.damage = error.message;
}

// ---- by the records ----

// The octets of the data stay as they are, whoever wrote them; what follows the last whole record is replaced by a summary,
// which does not name what is broken.
base::Result<Repair> keep_octets(const File& file, std::uint64_t size, const Index& index, const std::string& to) {
  auto out = File::create(to);
  if (!out) return out.error();
  std::uint32_t crc = 0;
  std::string piece;
  for (std::uint64_t offset = 0; offset < index.data_end; offset += piece.size()) {
    if (const auto done = file.read(offset, std::min(piece_size, index.data_end - offset), piece); !done) return done.error();
    crc = crc32(crc, piece);
    if (const auto done = out->append(piece); !done) return done.error();
  }
  if (const auto done = out->append(end_of_file(index.summary, index.data_end, crc)); !done) return done.error();

  const Broken& broken = index.broken;
  const std::uint64_t behind = index.has_data_end ? 0 : size - index.data_end;
  Repair repair{index.summary.statistics.messages,
                behind + broken.octets,
                broken.chunks,
                broken.are_counted ? std::optional(broken.messages) : std::nullopt,
                broken.attachments,
                broken.metadata,
                broken.others > 0,
                index.damage};
  std::uint32_t wanted = 0;
  if (index.has_data_end && file.read(index.data_end + record_head, sizeof wanted, piece)) wanted = Octets(piece).number<std::uint32_t>();
  if (wanted != 0 && wanted != crc) {
    repair.is_changed = true;
    note(repair, at(file, index.data_end, "data CRC mismatch outside the chunks, for example in metadata"));
  }
  // Of a file that its writer closed nothing is missing at the end.
  if (!index.has_data_end && size > magic.size() && file.read(size - magic.size(), magic.size(), piece) && piece == magic) {
    repair.messages_lost.reset();
  }
  return repair;
}

// ---- by the summary ----

// What a reader gives of a file, as a new one.
class Copy {
 public:
  Copy(Reader& from, const Summary& summary, Writer& to) : from_(from), summary_(summary), to_(to) {}

  base::Result<void> run() {
    for (const auto& step : {&Copy::describe, &Copy::metadata, &Copy::attachments, &Copy::messages}) {
      if (const auto done = (this->*step)(); !done) return done;
    }
    return to_.close();
  }

  Repair repair;

 private:
  base::Result<void> describe() {
    std::map<std::uint16_t, std::uint16_t> schemas{{0, 0}};
    for (const auto& [id, schema] : from_.schemas()) {
      const auto added = to_.add_schema(schema.name, schema.encoding, schema.data);
      if (!added) return added.error();
      schemas[id] = *added;
    }
    for (const auto& [id, channel] : from_.channels()) {
      const auto added = to_.add_channel(schemas[channel.schema], channel.topic, channel.encoding, channel.metadata);
      if (!added) return added.error();
      channels_[id] = *added;
    }
    return {};
  }

  base::Result<void> metadata() {
    for (std::size_t n = 0; n < from_.metadata_count(); ++n) {
      const auto one = from_.metadata(n);
      if (!one) {
        lose(repair.metadata_lost, summary_.metadata[n].length, one.error());
      } else if (const auto done = to_.add_metadata(*one); !done) {
        return done;
      }
    }
    return {};
  }

  base::Result<void> attachments() {
    for (std::size_t n = 0; n < summary_.attachments.size(); ++n) {
      const auto one = from_.attachment(n);
      if (!one) {
        lose(repair.attachments_lost, summary_.attachments[n].length, one.error());
      } else if (const auto done = to_.attach(*one); !done) {
        return done;
      }
    }
    return {};
  }

  base::Result<void> messages() {
    for (;;) {
      const auto message = from_.next();
      if (!message) {
        lose(repair.broken_chunks, 0, message.error());
        continue;
      }
      if (!message->has_value()) break;
      Message one = **message;
      one.channel = channels_.at(one.channel);
      if (const auto done = to_.write(one); !done) return done;
      ++repair.messages;
    }
    const std::uint64_t all = summary_.statistics.messages;
    repair.messages_lost = all - std::min(all, repair.messages);
    return {};
  }

  void lose(std::uint64_t& count, std::uint64_t octets, const base::Error& why) {
    note(repair, why);
    ++count;
    repair.octets_lost += octets;
  }

  Reader& from_;
  const Summary& summary_;
  Writer& to_;
  std::map<std::uint16_t, std::uint16_t> channels_;
};

base::Result<Repair> copy_by_summary(const std::string& from, const Summary& summary, const std::string& to) {
  auto reader = Reader::open(from);
  if (!reader) return reader.error();
  const std::string compression = summary.chunks.empty() ? "" : summary.chunks.front().compression;
  auto writer = Writer::create(to, {.profile = reader->profile(),
                                    .compression = compression == "zstd"  ? Compression::zstd
                                                   : compression == "lz4" ? Compression::lz4
                                                                          : Compression::none});
  if (!writer) return writer.error();
  Copy copy(*reader, summary, *writer);
  if (const auto done = copy.run(); !done) return done.error();
  return copy.repair;
}

// Whether a walk over the records finds all that the summary tells.
bool agrees(const base::Result<Index>& scanned, const Summary& summary) {
  if (!scanned || scanned->damage) return false;
  const Statistics &found = scanned->summary.statistics, &told = summary.statistics;
  return found.messages == told.messages && found.attachments == told.attachments && found.metadata == told.metadata &&
         found.chunks == told.chunks;
}

void add_channels(const Summary& from, Summary& to) {
  to.schemas.insert(from.schemas.begin(), from.schemas.end());
  to.channels.insert(from.channels.begin(), from.channels.end());
  to.statistics.schemas = static_cast<std::uint16_t>(to.schemas.size());
  to.statistics.channels = static_cast<std::uint32_t>(to.channels.size());
}

// A chunk that only is broken stays where it is, for those who can make something of its octets; where records are not found any more a
// new file is better.
bool is_worth_more(const Index& scanned, const Summary& summary, const Repair& copied) {
  const Statistics &found = scanned.summary.statistics, &told = summary.statistics;
  if (found.messages < copied.messages || found.messages > told.messages) return false;
  if (found.attachments + copied.attachments_lost < told.attachments || found.metadata + copied.metadata_lost < told.metadata) return false;
  return scanned.broken.chunks > 0 && scanned.broken.others == 0;
}

base::Result<Repair> write(const std::string& from, const std::string& to) {
  auto file = File::open(from);
  if (!file) return file.error();
  const auto size = file->size();
  if (!size) return size.error();
  auto scanned = scan(*file, Offsets::kept);
  std::optional<std::string> damage;
  const auto whole = read_summary(*file, *size, damage);
  const bool has_summary = whole && whole->has_value();
  if (!scanned && !has_summary) return scanned.error();
  // The record of a channel without messages may be in the summary alone.
  if (scanned && has_summary) add_channels((*whole)->summary, scanned->summary);
  if (!has_summary || agrees(scanned, (*whole)->summary)) return keep_octets(*file, *size, *scanned, to);

  auto copied = copy_by_summary(from, (*whole)->summary, to);
  if (copied && !(scanned && is_worth_more(*scanned, (*whole)->summary, *copied))) {
    if (scanned && scanned->damage && !copied->damage) copied->damage = scanned->damage;
    return copied;
  }
  if (!scanned) return copied;
  return keep_octets(*file, *size, *scanned, to);
}

}  // namespace

base::Result<Repair> repair(const std::string& from, const std::string& to) {
  if (const auto good = File::check_name(to); !good) return good.error();  // a rename would put a file in the place of a device
  if (File::is_being_written(to)) return base::Error{base::in_quotes(to) + ": is being written by another process"};
  const std::string whole = to + ".part";
  const auto done = write(from, whole);
  if (!done) {
    if (!File::is_being_written(whole)) std::remove(whole.c_str());
    return done.error();
  }
  struct stat before {};
  if (::stat(to.c_str(), &before) == 0) (void)::chmod(whole.c_str(), before.st_mode & 07777);  // as who made it wants it
  if (std::rename(whole.c_str(), to.c_str()) != 0) {
    const base::Error error{base::in_quotes(to) + ": cannot be written: " + std::strerror(errno)};
    std::remove(whole.c_str());
    return error;
  }
  return done;
}

}  // namespace mcap

#include "recording/mcap/scan.h"

#include <algorithm>
#include <set>
#include <utility>

#include "base/text.h"
#include "recording/mcap/compression.h"

namespace mcap {

namespace {

// Schemas, channels and the rest of what an index keeps, as they are met.
class Collector {
 public:
  Collector(const File& file, Index& index) : file_(file), index_(index) {}

  base::Result<void> describe(Opcode opcode, std::string_view content, std::uint64_t offset) {
    described_ += content.size();
    if (described_ > max_descriptions) {
      return at(file_, offset, "schemas and channels of more than " + std::to_string(max_descriptions) + " bytes are not read");
    }
    if (opcode == Opcode::schema) {
      auto schema = take_schema(content);
      if (!schema) return at(file_, offset, "the schema is cut off");
      const auto id = schema->id;
      if (id != 0) index_.summary.schemas.emplace(id, std::move(*schema));
    } else {
      auto channel = take_channel(content);
      if (!channel) return at(file_, offset, "the channel is cut off");
      const auto id = channel->id;
      index_.summary.channels.emplace(id, std::move(*channel));
    }
    return {};
  }

 private:
  const File& file_;
  Index& index_;
  std::uint64_t described_ = 0;
};

void note(Index& index, const base::Error& error) {
  if (!index.damage) index.damage = error.message;
}

// Octets of a file that is read from its begin to its end: one system call for many small records.
class BlockReader {
 public:
  BlockReader(const File& file, std::uint64_t end) : file_(file), end_(end) {}

  // Exactly `size` octets, which lie before the end. Valid until the next call.
  base::Result<std::string_view> octets(std::uint64_t offset, std::uint64_t size) {
    if (offset < start_ || offset + size > start_ + block_.size()) {
      constexpr std::uint64_t usual_size = 64 << 10;  // [bytes]
      start_ = offset;
      if (const auto done = file_.read(offset, std::max(size, std::min(usual_size, end_ - offset)), block_); !done) return done.error();
    }
    return std::string_view(block_).substr(offset - start_, size);
  }

 private:
  const File& file_;
  const std::uint64_t end_;
  std::uint64_t start_ = 0;
  std::string block_;
};

// Of the record that every file begins with.
base::Result<std::uint64_t> read_header(const File& file, std::uint64_t size, Index& index) {
  std::string octets;
  const std::uint64_t first = std::min<std::uint64_t>(size, magic.size());
  if (const auto done = file.read(0, first, octets); !done) return done.error();
  if (octets != magic) return base::Error{base::in_quotes(file.path()) + ": is not an MCAP file: it does not start with the magic bytes"};
  const auto head = read_head(file, magic.size(), size);
  if (!head) return head.error();
  if (!head->has_value() || (*head)->opcode != Opcode::header) return at(file, magic.size(), "expected the header of an MCAP file");
  if ((*head)->length > max_descriptions) return at(file, magic.size(), "the header is longer than any header is");
  if (const auto done = file.read(magic.size() + record_head, (*head)->length, octets); !done) return done.error();
  Octets in(octets);
  index.profile = in.text();
  index.library = in.text();
  if (!in.ok()) return at(file, magic.size(), "the header is cut off");
  return magic.size() + record_head + (*head)->length;
}

// The content of the footer, when the file ends with one.
struct Footer {
  std::uint64_t offset = 0;
  std::uint64_t summary_start = 0;
  std::uint32_t crc = 0;
};

base::Result<std::optional<Footer>> read_footer(const File& file, std::uint64_t size) {
  if (size < 2 * magic.size() + footer_record) return std::optional<Footer>();
  const std::uint64_t offset = size - magic.size() - footer_record;
  std::string octets;
  if (const auto done = file.read(offset, footer_record + magic.size(), octets); !done) return done.error();
  Octets in(octets);
  if (static_cast<Opcode>(in.number<std::uint8_t>()) != Opcode::footer || in.number<std::uint64_t>() != footer_record - record_head ||
      !octets.ends_with(magic)) {
    return std::optional<Footer>();
  }
  Footer footer;
  footer.offset = offset;
  footer.summary_start = in.number<std::uint64_t>();
  (void)in.number<std::uint64_t>();  // where the offsets of the groups begin; not needed to read all of them
  footer.crc = in.number<std::uint32_t>();
  return std::optional<Footer>(footer);
}

bool is_in_file(std::uint64_t start, std::uint64_t length, std::uint64_t end) { return start <= end && length <= end - start; }

base::Result<void> take_summary_record(const File& file, Opcode opcode, std::string_view content, std::uint64_t offset,
                                       std::uint64_t data_end, Collector& collector, Index& index, bool& has_statistics) {
  const auto wrong = [&] { return at(file, offset, "a record of the summary is cut off or points outside of the data"); };
  Summary& summary = index.summary;
  switch (opcode) {
    case Opcode::schema:
    case Opcode::channel:
      return collector.describe(opcode, content, offset);
    case Opcode::chunk_index: {
      auto entry = take_chunk_index(content);
      if (!entry || !is_in_file(entry->start, entry->length, data_end)) return wrong();
      const auto offsets = std::exchange(entry->index_offsets, {});
      std::vector<std::uint16_t> channels;
      for (const auto& [channel, place] : offsets) channels.push_back(channel);
      entry->channels = ChannelSet(std::move(channels));
      summary.chunks.push_back(std::move(*entry));
      return {};
    }
    case Opcode::attachment_index: {
      auto place = take_attachment_index(content);
      if (!place || !is_in_file(place->start, place->length, data_end)) return wrong();
      summary.attachments.push_back(std::move(*place));
      return {};
    }
    case Opcode::metadata_index: {
      auto place = take_metadata_index(content);
      if (!place || !is_in_file(place->start, place->length, data_end)) return wrong();
      summary.metadata.push_back(std::move(*place));
      return {};
    }
    case Opcode::statistics: {
      auto statistics = take_statistics(content);
      if (!statistics) return wrong();
      summary.statistics = std::move(*statistics);
      has_statistics = true;
      return {};
    }
    default:
      return {};  // of a later version of the format, or somebody's own
  }
}

// Whether the summary says enough: writers may leave parts of it out.
bool is_enough(const Index& index, bool has_statistics, std::uint64_t header_end, std::uint64_t data_end) {
  const Summary& summary = index.summary;
  if (!has_statistics || summary.statistics.chunks != summary.chunks.size()) return false;
  if (summary.statistics.attachments != summary.attachments.size() || summary.statistics.metadata != summary.metadata.size()) return false;
  std::uint64_t known = header_end;  // [bytes] of the data that the summary accounts for
  std::vector<bool> seen;            // channels, by ID
  for (const ChunkEntry& entry : summary.chunks) {
    known += entry.length + entry.index_length;
    entry.channels.add_to(seen);
  }
  for (const AttachmentPlace& place : summary.attachments) known += place.length;
  for (const MetadataPlace& place : summary.metadata) known += place.length;
  if (known > data_end || data_end - known > record_head + 4) return false;  // messages outside of chunks
  for (std::size_t id = 0; id < seen.size(); ++id) {
    if (seen[id] && !summary.channels.contains(static_cast<std::uint16_t>(id))) return false;
  }
  const auto is_known = [&](const auto& count) { return summary.channels.contains(count.first); };
  return std::ranges::all_of(summary.statistics.messages_of, is_known);
}

base::Result<std::uint32_t> crc_of(const File& file, std::uint64_t offset, std::uint64_t size) {
  constexpr std::uint64_t max_at_once = 1 << 20;  // [bytes]
  std::uint32_t crc = 0;
  std::string octets;
  for (std::uint64_t done = 0; done < size; done += octets.size()) {
    if (const auto read = file.read(offset + done, std::min(max_at_once, size - done), octets); !read) return read.error();
    crc = crc32(crc, octets);
  }
  return crc;
}

// Walks over the data of a file.
class Scanner {
 public:
  Scanner(const File& file, Index& index, Offsets offsets) : file_(file), index_(index), offsets_(offsets), collector_(file, index) {}

  base::Result<void> walk(std::uint64_t start, std::uint64_t end) {
    std::uint64_t offset = start;
    while (offset < end) {
      index_.data_end = offset;
      if (end - offset == magic.size()) break;  // behind a footer
      const auto head = read_head(file_, offset, end);
      if (!head) return head.error();
      if (!head->has_value()) {
        note(index_, at(file_, offset, "the last record is truncated; the records before it are read"));
        index_.cut_off = end - offset;
        end_broken();
        return {};
      }
      if (is_end(**head)) {
        index_.has_data_end = true;
        end_broken();
        if (index_.broken.chunks > 0) describe_from_summary(offset, end);
        return {};
      }
      if (const auto done = take(**head, offset); !done) return done;
      offset += record_head + (*head)->length;
    }
    index_.data_end = std::min(offset, end);
    end_broken();
    return {};
  }

 private:
  // Another record whose opcode was changed into one of these has another length.
  static bool is_end(const RecordHead& head) {
    return (head.opcode == Opcode::data_end && head.length == sizeof(std::uint32_t)) ||
           (head.opcode == Opcode::footer && head.length == footer_record - record_head);
  }

  // A broken chunk may have been the only place in the data where a channel was described; the summary has all of them. What of it cannot
  // be read does not help.
  void describe_from_summary(std::uint64_t offset, std::uint64_t end) {
    while (const auto head = read_head(file_, offset, end)) {
      if (!head->has_value()) return;
      if ((*head)->opcode == Opcode::schema || (*head)->opcode == Opcode::channel) {
        if ((*head)->length > max_descriptions || !file_.read(offset + record_head, (*head)->length, octets_)) return;
        if (!collector_.describe((*head)->opcode, octets_, offset)) return;
      }
      offset += record_head + (*head)->length;
    }
  }

  // Behind the indexes of a chunk.
  void end_broken() {
    if (in_broken_ == In::chunk && !has_broken_index_) index_.broken.are_counted = false;
    in_broken_ = In::none;
    has_broken_index_ = false;
  }

  void lose(std::uint64_t& count, const RecordHead& head, const base::Error& why) {
    note(index_, why);
    ++count;
    index_.broken.octets += record_head + head.length;
  }

  base::Result<void> take(const RecordHead& head, std::uint64_t offset) {
    const std::uint64_t content = offset + record_head;
    if (head.opcode != Opcode::message_index) end_broken();
    switch (head.opcode) {
      case Opcode::schema:
      case Opcode::channel: {
        if (head.length > max_descriptions) return at(file_, offset, "a schema or channel is longer than any is");
        if (const auto done = file_.read(content, head.length, octets_); !done) return done;
        return collector_.describe(head.opcode, octets_, offset);
      }
      case Opcode::message:
        return take_loose(head, offset);
      case Opcode::chunk:
        return take_chunk_record(head, offset);
      case Opcode::message_index:
        return take_message_index(head, offset);
      case Opcode::attachment:
        return take_attachment(head, offset);
      case Opcode::metadata: {
        if (head.length > max_descriptions) return at(file_, offset, "metadata are longer than any are");
        if (const auto done = file_.read(content, head.length, octets_); !done) return done;
        Octets in(octets_);
        std::string name(in.text());
        (void)in.texts();
        if (!in.ok())
          return lose(index_.broken.metadata, head, at(file_, offset, "metadata are cut off; they are left out")), base::Result<void>();
        index_.summary.metadata.push_back({offset, record_head + head.length, std::move(name)});
        ++index_.summary.statistics.metadata;
        return {};
      }
      default:
        return take_unknown(head, offset), base::Result<void>();
    }
  }

  // The format leaves opcodes to others, who may know what to do with their records; we write none of these.
  void take_unknown(const RecordHead& head, std::uint64_t offset) {
    constexpr int first_private = 0x80;
    if (static_cast<int>(head.opcode) >= first_private && index_.library != own_library) return;
    lose(index_.broken.others, head,
         at(file_, offset, "a record of kind " + std::to_string(static_cast<int>(head.opcode)) + " among the data is left out"));
    in_broken_ = In::unknown;
  }

  base::Result<void> take_loose(const RecordHead& head, std::uint64_t offset) {
    if (const auto done = file_.read(offset + record_head, std::min<std::uint64_t>(head.length, message_head), octets_); !done) return done;
    const auto message = take_message(octets_);
    if (!message) return note(index_, at(file_, offset, "a message is shorter than any is; it is left out")), base::Result<void>();
    index_.loose.push_back({message->log_time, offset, head.length});
    count(index_.summary.statistics, *message, index_.summary.statistics.messages_of[message->channel]);
    return {};
  }

  base::Result<void> take_chunk_record(const RecordHead& head, std::uint64_t offset) {
    if (const auto done = read_chunk(file_, offset, record_head + head.length, octets_); !done) {
      lose(index_.broken.chunks, head, done.error());
      in_broken_ = In::chunk;
      return {};
    }
    ChunkEntry entry;
    entry.start = offset;
    entry.length = record_head + head.length;
    entry.uncompressed = octets_.size();
    std::set<std::uint16_t> channels;
    bool has_messages = false;
    base::Result<void> result;
    const auto walked = for_each_record(octets_, [&](Opcode opcode, std::string_view content, std::uint64_t) {
      if (opcode == Opcode::schema || opcode == Opcode::channel) {
        if (result) result = collector_.describe(opcode, content, offset);
      }
      if (opcode != Opcode::message) return;
      const auto message = take_message(content);
      if (!message) return;
      entry.first = has_messages ? std::min(entry.first, message->log_time) : message->log_time;
      entry.last = has_messages ? std::max(entry.last, message->log_time) : message->log_time;
      has_messages = true;
      channels.insert(message->channel);
      count(index_.summary.statistics, *message, index_.summary.statistics.messages_of[message->channel]);
    });
    if (!walked) note(index_, at(file_, offset, "in the chunk: " + walked.error().message));
    if (!result) return result;
    entry.channels = ChannelSet({channels.begin(), channels.end()});
    if (const auto fields = chunk_fields(offset, head.length)) {
      entry.compression = fields->first;
      entry.compressed = fields->second;
    }
    index_.summary.chunks.push_back(std::move(entry));
    ++index_.summary.statistics.chunks;
    return {};
  }

  // Name of the compression and compressed octets of a chunk that has been read.
  std::optional<std::pair<std::string, std::uint64_t>> chunk_fields(std::uint64_t offset, std::uint64_t length) {
    std::string head;
    if (!file_.read(offset + record_head, std::min<std::uint64_t>(length, 64), head)) return std::nullopt;
    Octets in(head);
    (void)in.part(8 + 8 + 8 + 4);
    const std::string name(in.text());
    const auto compressed = in.number<std::uint64_t>();
    if (!in.ok()) return std::nullopt;
    return std::pair{name, compressed};
  }

  // Only where it stands, for the index of a repaired file.
  base::Result<void> take_message_index(const RecordHead& head, std::uint64_t offset) {
    constexpr std::uint64_t index_head = 2 + 4, index_entry = 16;  // [bytes]
    if (in_broken_ == In::unknown) {                               // it was a chunk
      in_broken_ = In::chunk;
      --index_.broken.others;
      ++index_.broken.chunks;
    }
    if (in_broken_ == In::chunk) {
      has_broken_index_ = true;
      if (head.length >= index_head) index_.broken.messages += (head.length - index_head) / index_entry;
      return {};
    }
    if (index_.summary.chunks.empty() || head.length < 2) return {};
    ChunkEntry& chunk = index_.summary.chunks.back();
    chunk.index_length += record_head + head.length;
    if (offsets_ == Offsets::left_out) return {};
    if (const auto done = file_.read(offset + record_head, 2, octets_); !done) return done;
    const auto channel = Octets(octets_).number<std::uint16_t>();
    if (!chunk.channels.contains(channel)) return {};
    const auto known = std::ranges::find(chunk.index_offsets, channel, [](const auto& one) { return one.first; });
    if (known == chunk.index_offsets.end())
      chunk.index_offsets.emplace_back(channel, offset);
    else
      known->second = offset;
    return {};
  }

  base::Result<void> take_attachment(const RecordHead& head, std::uint64_t offset) {
    if (const auto done = file_.read(offset + record_head, std::min<std::uint64_t>(head.length, 64 * 1024), octets_); !done) return done;
    Octets in(octets_);
    AttachmentPlace place;
    place.start = offset;
    place.length = record_head + head.length;
    place.log_time = in.time();
    place.create_time = in.time();
    place.name = in.text();
    place.media_type = in.text();
    place.size = in.number<std::uint64_t>();
    const std::uint64_t before = std::min<std::uint64_t>(head.length, 64 * 1024) - in.rest().size();
    if (!in.ok() || place.size > head.length - before || head.length - before - place.size < sizeof(std::uint32_t))
      return lose(index_.broken.attachments, head, at(file_, offset, "an attachment is cut off; it is left out")), base::Result<void>();
    const auto is_good = has_good_crc(offset + record_head, before + place.size);
    if (!is_good) return is_good.error();
    if (!*is_good)
      return lose(index_.broken.attachments, head, at(file_, offset, "an attachment does not match its CRC; it is left out")),
             base::Result<void>();
    index_.summary.attachments.push_back(std::move(place));
    ++index_.summary.statistics.attachments;
    return {};
  }

  // Of an attachment, by so many octets; behind them stands their CRC, or 0.
  base::Result<bool> has_good_crc(std::uint64_t offset, std::uint64_t size) {
    if (const auto done = file_.read(offset + size, sizeof(std::uint32_t), octets_); !done) return done.error();
    const auto wanted = Octets(octets_).number<std::uint32_t>();
    if (wanted == 0) return true;
    const auto crc = crc_of(file_, offset, size);
    if (!crc) return crc.error();
    return *crc == wanted;
  }

  const File& file_;
  Index& index_;
  const Offsets offsets_;
  Collector collector_;
  std::string octets_;
  enum class In { none, chunk, unknown };
  In in_broken_ = In::none;        // behind a record that cannot be read, among the indexes of what may have been a chunk
  bool has_broken_index_ = false;  // of which there is one at least
};

}  // namespace

base::Result<Index> scan(const File& file, Offsets offsets) {
  const auto size = file.size();
  if (!size) return size.error();
  Index index;
  const auto start = read_header(file, *size, index);
  if (!start) return start.error();
  if (const auto done = Scanner(file, index, offsets).walk(*start, *size); !done) return done.error();
  return index;
}

base::Result<std::optional<Index>> read_summary(const File& file, std::uint64_t size, std::optional<std::string>& damage) {
  Index index;
  const auto header_end = read_header(file, size, index);
  if (!header_end) return header_end.error();
  const auto footer = read_footer(file, size);
  if (!footer) return footer.error();
  const auto broken = [&](std::uint64_t offset, const char* what) {
    damage = at(file, offset, what).message;
    return std::optional<Index>();
  };
  if (!footer->has_value()) return broken(size, "the file has no end: its writer did not close it, or it is cut off; what it has is read");
  if ((*footer)->summary_start == 0) return std::optional<Index>();
  if ((*footer)->summary_start < *header_end || (*footer)->summary_start > (*footer)->offset) {
    return broken((*footer)->offset, "the footer points outside of the file; the file is read without a summary");
  }
  const std::uint64_t start = (*footer)->summary_start, end = size - magic.size();
  if ((*footer)->crc != 0) {
    const auto crc = crc_of(file, start, end - sizeof(std::uint32_t) - start);
    if (!crc) return crc.error();
    if (*crc != (*footer)->crc) return broken(start, "the summary does not match its CRC; the file is read without it");
  }

  // Block by block: the summary of ten minutes of 2000 channels has 130 MB.
  Collector collector(file, index);
  bool has_statistics = false;
  BlockReader blocks(file, end);
  for (std::uint64_t offset = start; offset < end;) {
    const auto octets = blocks.octets(offset, std::min<std::uint64_t>(record_head, end - offset));
    if (!octets) return octets.error();
    const auto head = to_head(*octets, end - offset);
    if (!head) return broken(start, "the summary is cut off; the file is read without it");
    offset += record_head;
    const auto content = blocks.octets(offset, head->length);
    if (!content) return content.error();
    const auto taken = take_summary_record(file, head->opcode, *content, offset, start, collector, index, has_statistics);
    if (!taken) return damage = taken.error().message, std::optional<Index>();
    offset += head->length;
  }
  if (!is_enough(index, has_statistics, *header_end, start)) return std::optional<Index>();
  index.data_end = start;
  return std::optional<Index>(std::move(index));
}

base::Result<Index> read_index(const File& file) {
  const auto size = file.size();
  if (!size) return size.error();
  std::optional<std::string> damage;
  auto index = read_summary(file, *size, damage);
  if (!index) return index.error();
  if (index->has_value()) return std::move(**index);
  auto scanned = scan(file, Offsets::left_out);
  if (scanned && !scanned->damage) scanned->damage = damage;
  return scanned;
}

}  // namespace mcap

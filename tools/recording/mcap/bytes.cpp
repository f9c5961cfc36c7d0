#include "recording/mcap/bytes.h"

namespace mcap {

namespace {

// A content that is written after its length is known: the length is filled in at the end.
class Record {
 public:
  Record(std::string& out, Opcode opcode) : out_(out) {
    out_.push_back(static_cast<char>(opcode));
    put(out_, std::uint64_t{0});
    start_ = out_.size();
  }
  ~Record() {
    const std::uint64_t length = out_.size() - start_;
    std::memcpy(out_.data() + start_ - sizeof length, &length, sizeof length);
  }
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

 private:
  std::string& out_;
  std::size_t start_ = 0;
};

template <class Value>
std::optional<Value> if_whole(const Octets& in, Value value) {
  if (!in.ok()) return std::nullopt;
  return value;
}

template <class Pairs>
void put_offsets(std::string& out, const Pairs& numbers) {
  put(out, static_cast<std::uint32_t>(numbers.size() * 10));
  for (const auto& [id, number] : numbers) {
    put(out, id);
    put(out, number);
  }
}

template <class Pairs>
Pairs take_offsets(Octets& in) {
  Pairs numbers;
  Octets part = in.part(in.number<std::uint32_t>());
  while (!part.is_empty()) {
    const auto id = part.number<std::uint16_t>();
    const auto number = part.number<std::uint64_t>();
    if (part.ok()) numbers.insert(numbers.end(), {id, number});
  }
  return numbers;
}

}  // namespace

void put_texts(std::string& out, const Texts& texts) {
  std::uint32_t size = 0;
  for (const auto& [key, value] : texts) size += static_cast<std::uint32_t>(8 + key.size() + value.size());
  put(out, size);
  for (const auto& [key, value] : texts) {
    put_text(out, key);
    put_text(out, value);
  }
}

void put_record(std::string& out, Opcode opcode, std::string_view content) {
  out.push_back(static_cast<char>(opcode));
  put(out, static_cast<std::uint64_t>(content.size()));
  out.append(content);
}

Texts Octets::texts() {
  Texts texts;
  Octets part = this->part(number<std::uint32_t>());
  while (!part.is_empty()) {
    const std::string_view key = part.text();
    const std::string_view value = part.text();
    if (part.ok()) texts.emplace(key, value);
  }
  ok_ = ok_ && part.ok();
  return texts;
}

void put_schema(std::string& out, const Schema& schema) {
  const Record record(out, Opcode::schema);
  put(out, schema.id);
  put_text(out, schema.name);
  put_text(out, schema.encoding);
  put_text(out, schema.data);
}

std::optional<Schema> take_schema(std::string_view content) {
  Octets in(content);
  Schema schema;
  schema.id = in.number<std::uint16_t>();
  schema.name = in.text();
  schema.encoding = in.text();
  schema.data = in.text();
  return if_whole(in, std::move(schema));
}

void put_channel(std::string& out, const Channel& channel) {
  const Record record(out, Opcode::channel);
  put(out, channel.id);
  put(out, channel.schema);
  put_text(out, channel.topic);
  put_text(out, channel.encoding);
  put_texts(out, channel.metadata);
}

std::optional<Channel> take_channel(std::string_view content) {
  Octets in(content);
  Channel channel;
  channel.id = in.number<std::uint16_t>();
  channel.schema = in.number<std::uint16_t>();
  channel.topic = in.text();
  channel.encoding = in.text();
  channel.metadata = in.texts();
  return if_whole(in, std::move(channel));
}

std::optional<Message> take_message(std::string_view content) {
  Octets in(content);
  Message message;
  message.channel = in.number<std::uint16_t>();
  message.sequence = in.number<std::uint32_t>();
  message.log_time = in.time();
  message.publish_time = in.time();
  message.data = in.rest();
  return if_whole(in, message);
}

void put_chunk_index(std::string& out, const ChunkEntry& entry) {
  const Record record(out, Opcode::chunk_index);
  put(out, entry.first);
  put(out, entry.last);
  put(out, entry.start);
  put(out, entry.length);
  put_offsets(out, entry.index_offsets);
  put(out, entry.index_length);
  put_text(out, entry.compression);
  put(out, entry.compressed);
  put(out, entry.uncompressed);
}

std::optional<ChunkEntry> take_chunk_index(std::string_view content) {
  Octets in(content);
  ChunkEntry entry;
  entry.first = in.time();
  entry.last = in.time();
  entry.start = in.number<std::uint64_t>();
  entry.length = in.number<std::uint64_t>();
  entry.index_offsets = take_offsets<decltype(entry.index_offsets)>(in);
  entry.index_length = in.number<std::uint64_t>();
  entry.compression = in.text();
  entry.compressed = in.number<std::uint64_t>();
  entry.uncompressed = in.number<std::uint64_t>();
  return if_whole(in, std::move(entry));
}

std::optional<ChunkHead> take_chunk(std::string_view content) {
  Octets in(content);
  ChunkHead head;
  head.first = in.time();
  head.last = in.time();
  head.uncompressed = in.number<std::uint64_t>();
  head.crc = in.number<std::uint32_t>();
  head.compression = in.text();
  head.records = in.long_text();
  return if_whole(in, head);
}

void put_attachment_index(std::string& out, const AttachmentPlace& place) {
  const Record record(out, Opcode::attachment_index);
  put(out, place.start);
  put(out, place.length);
  put(out, place.log_time);
  put(out, place.create_time);
  put(out, place.size);
  put_text(out, place.name);
  put_text(out, place.media_type);
}

std::optional<AttachmentPlace> take_attachment_index(std::string_view content) {
  Octets in(content);
  AttachmentPlace place;
  place.start = in.number<std::uint64_t>();
  place.length = in.number<std::uint64_t>();
  place.log_time = in.time();
  place.create_time = in.time();
  place.size = in.number<std::uint64_t>();
  place.name = in.text();
  place.media_type = in.text();
  return if_whole(in, std::move(place));
}

void put_metadata_index(std::string& out, const MetadataPlace& place) {
  const Record record(out, Opcode::metadata_index);
  put(out, place.start);
  put(out, place.length);
  put_text(out, place.name);
}

std::optional<MetadataPlace> take_metadata_index(std::string_view content) {
  Octets in(content);
  MetadataPlace place;
  place.start = in.number<std::uint64_t>();
  place.length = in.number<std::uint64_t>();
  place.name = in.text();
  return if_whole(in, std::move(place));
}

void put_statistics(std::string& out, const Statistics& statistics) {
  const Record record(out, Opcode::statistics);
  put(out, statistics.messages);
  put(out, statistics.schemas);
  put(out, statistics.channels);
  put(out, statistics.attachments);
  put(out, statistics.metadata);
  put(out, statistics.chunks);
  put(out, statistics.first);
  put(out, statistics.last);
  put_offsets(out, statistics.messages_of);
}

std::optional<Statistics> take_statistics(std::string_view content) {
  Octets in(content);
  Statistics statistics;
  statistics.messages = in.number<std::uint64_t>();
  statistics.schemas = in.number<std::uint16_t>();
  statistics.channels = in.number<std::uint32_t>();
  statistics.attachments = in.number<std::uint32_t>();
  statistics.metadata = in.number<std::uint32_t>();
  statistics.chunks = in.number<std::uint32_t>();
  statistics.first = in.time();
  statistics.last = in.time();
  statistics.messages_of = take_offsets<decltype(statistics.messages_of)>(in);
  return if_whole(in, std::move(statistics));
}

}  // namespace mcap

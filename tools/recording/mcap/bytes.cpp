#include "recording/mcap/bytes.h"

#include <algorithm>
#include <tuple>
#include <type_traits>

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

template <class Pairs>
void put_offsets(std::string& out, const Pairs& numbers) {
  put(out, static_cast<std::uint32_t>(numbers.size() * 10));
  for (const auto& [id, number] : numbers) {
    put(out, id);
    put(out, number);
  }
}

template <class Pairs>
void take_offsets(Octets& in, Pairs& numbers) {
  Octets part = in.part(in.number<std::uint32_t>());
  while (!part.is_empty()) {
    const auto id = part.number<std::uint16_t>();
    const auto number = part.number<std::uint64_t>();
    if (part.ok()) numbers.insert(numbers.end(), {id, number});
  }
}

template <class Member>
void put_member(std::string& out, const Member& member) {
  if constexpr (std::is_arithmetic_v<Member> || std::is_same_v<Member, Time>)
    put(out, member);
  else if constexpr (std::is_same_v<Member, std::string>)
    put_text(out, member);
  else if constexpr (std::is_same_v<Member, Texts>)
    put_texts(out, member);
  else
    put_offsets(out, member);
}

template <class Member>
void take_member(Octets& in, Member& member) {
  if constexpr (std::is_arithmetic_v<Member>)
    member = in.number<Member>();
  else if constexpr (std::is_same_v<Member, Time>)
    member = in.time();
  else if constexpr (std::is_same_v<Member, std::string>)
    member = in.text();
  else if constexpr (std::is_same_v<Member, Texts>)
    member = in.texts();
  else
    take_offsets(in, member);
}

// `members` returns those of a record in the order of the format.
template <class Value, class Members>
void put_members(std::string& out, Opcode opcode, const Value& value, Members members) {
  const Record record(out, opcode);
  std::apply([&](const auto&... each) { (put_member(out, each), ...); }, members(value));
}

template <class Value, class Members>
std::optional<Value> take_members(std::string_view content, Members members) {
  Octets in(content);
  Value value;
  std::apply([&](auto&... each) { (take_member(in, each), ...); }, members(value));
  if (!in.ok()) return std::nullopt;
  return value;
}

constexpr auto of_schema = [](auto& one) { return std::tie(one.id, one.name, one.encoding, one.data); };
constexpr auto of_channel = [](auto& one) { return std::tie(one.id, one.schema, one.topic, one.encoding, one.metadata); };
constexpr auto of_chunk_index = [](auto& one) {
  return std::tie(one.first, one.last, one.start, one.length, one.index_offsets, one.index_length, one.compression, one.compressed,
                  one.uncompressed);
};
constexpr auto of_attachment_index = [](auto& one) {
  return std::tie(one.start, one.length, one.log_time, one.create_time, one.size, one.name, one.media_type);
};
constexpr auto of_metadata_index = [](auto& one) { return std::tie(one.start, one.length, one.name); };
constexpr auto of_statistics = [](auto& one) {
  return std::tie(one.messages, one.schemas, one.channels, one.attachments, one.metadata, one.chunks, one.first, one.last, one.messages_of);
};

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

void put_schema(std::string& out, const Schema& schema) { put_members(out, Opcode::schema, schema, of_schema); }
std::optional<Schema> take_schema(std::string_view content) { return take_members<Schema>(content, of_schema); }

void put_channel(std::string& out, const Channel& channel) { put_members(out, Opcode::channel, channel, of_channel); }
std::optional<Channel> take_channel(std::string_view content) { return take_members<Channel>(content, of_channel); }

std::optional<Message> take_message(std::string_view content) {
  Octets in(content);
  Message message;
  message.channel = in.number<std::uint16_t>();
  message.sequence = in.number<std::uint32_t>();
  message.log_time = in.time();
  message.publish_time = in.time();
  message.data = in.rest();
  return in.ok() ? std::optional(message) : std::nullopt;
}

ChannelSet::ChannelSet(std::vector<std::uint16_t> channels) {
  std::ranges::sort(channels);
  for (const std::uint16_t channel : channels) {
    if (!runs_.empty() && channel <= runs_.back().second + 1)
      runs_.back().second = channel;
    else
      runs_.emplace_back(channel, channel);
  }
  runs_.shrink_to_fit();
}

bool ChannelSet::contains(std::uint16_t channel) const {
  const auto run = std::ranges::lower_bound(runs_, channel, {}, [](const auto& one) { return one.second; });
  return run != runs_.end() && run->first <= channel;
}

void ChannelSet::add_to(std::vector<bool>& all) const {
  if (is_empty()) return;
  all.resize(std::max(all.size(), runs_.back().second + std::size_t{1}));
  for (const auto& [first, last] : runs_) std::fill(all.begin() + first, all.begin() + last + 1, true);
}

void put_chunk_index(std::string& out, const ChunkEntry& entry) { put_members(out, Opcode::chunk_index, entry, of_chunk_index); }
std::optional<ChunkEntry> take_chunk_index(std::string_view content) { return take_members<ChunkEntry>(content, of_chunk_index); }

std::optional<ChunkHead> take_chunk(std::string_view content) {
  Octets in(content);
  ChunkHead head;
  head.first = in.time();
  head.last = in.time();
  head.uncompressed = in.number<std::uint64_t>();
  head.crc = in.number<std::uint32_t>();
  head.compression = in.text();
  head.records = in.long_text();
  return in.ok() ? std::optional(head) : std::nullopt;
}

void put_attachment_index(std::string& out, const AttachmentPlace& place) {
  put_members(out, Opcode::attachment_index, place, of_attachment_index);
}
std::optional<AttachmentPlace> take_attachment_index(std::string_view content) {
  return take_members<AttachmentPlace>(content, of_attachment_index);
}

void put_metadata_index(std::string& out, const MetadataPlace& place) {
  put_members(out, Opcode::metadata_index, place, of_metadata_index);
}
std::optional<MetadataPlace> take_metadata_index(std::string_view content) {
  return take_members<MetadataPlace>(content, of_metadata_index);
}

void put_statistics(std::string& out, const Statistics& statistics) { put_members(out, Opcode::statistics, statistics, of_statistics); }
std::optional<Statistics> take_statistics(std::string_view content) { return take_members<Statistics>(content, of_statistics); }

}  // namespace mcap

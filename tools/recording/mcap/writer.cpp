#include <algorithm>
#include <utility>
#include <vector>

#include "base/text.h"
#include "recording/mcap/bytes.h"
#include "recording/mcap/compression.h"
#include "recording/mcap/file.h"
#include "recording/mcap/summary.h"

namespace mcap {

namespace {

constexpr std::size_t most = 65535;  // schemas, channels: ids have 16 bits

struct IndexEntry {
  Time time;
  std::uint64_t offset;
};

}  // namespace

struct Writer::State {
  State(File file_, const WriterOptions& options_) : file(std::move(file_)), options(options_), compressor(options_.compression) {}

  base::Result<void> begin();
  base::Result<void> append(std::string_view octets);
  base::Result<void> append_chunk(std::string_view records, std::uint32_t records_crc);
  base::Result<void> put_out(std::string_view first, std::string_view second = {});
  base::Result<void> close_chunk();
  void introduce(std::uint16_t channel);
  void introduce_all();
  base::Result<void> finish();

  File file;
  WriterOptions options;
  Compressor compressor;
  std::optional<base::Error> failure;
  bool is_closed = false;
  std::uint64_t written = 0;  // octets in the file
  std::uint32_t crc = 0;      // of these

  Summary summary;
  std::vector<bool> is_introduced;         // channels whose record is in the file already
  std::size_t next_to_introduce = 1;       // all channels below it are
  std::vector<bool> is_schema_introduced;  // schemas likewise

  std::string chunk;  // records of the open one, not compressed
  Time first{0};
  Time last{0};
  std::vector<std::vector<IndexEntry>> indexes;  // of the open chunk, by channel
  std::vector<std::uint64_t*> counts;            // in the statistics, by channel; null: no message yet
  std::vector<std::uint16_t> in_chunk;           // channels with messages in it
  std::string room;                              // of the compressor
  std::string head;
};

base::Result<void> Writer::State::put_out(std::string_view first_part, std::string_view second) {
  if (failure) return *failure;
  const auto done = file.append(first_part, second);
  if (!done) {
    failure = done.error();
    file.cut(written);
    return done;
  }
  written += first_part.size() + second.size();
  return {};
}

base::Result<void> Writer::State::append(std::string_view octets) {
  const auto done = put_out(octets);
  if (done) crc = crc32(crc, octets);
  return done;
}

// `head` and then the records. Each octet is looked at once for both sums.
base::Result<void> Writer::State::append_chunk(std::string_view records, std::uint32_t records_crc) {
  const auto done = put_out(head, records);
  if (done) crc = joined_crc32(crc32(crc, head), records_crc, records.size());
  return done;
}

base::Result<void> Writer::State::begin() {
  std::string content;
  put_text(content, options.profile);
  put_text(content, own_library);
  std::string start(magic);
  put_record(start, Opcode::header, content);
  return append(start);
}

// Records of a channel and its schema stand in the file before the first message of the channel.
void Writer::State::introduce(std::uint16_t channel) {
  if (is_introduced[channel]) return;
  const std::uint16_t schema = summary.channels[channel].schema;
  if (schema != 0 && !is_schema_introduced[schema]) {
    put_schema(chunk, summary.schemas[schema]);
    is_schema_introduced[schema] = true;
  }
  put_channel(chunk, summary.channels[channel]);
  is_introduced[channel] = true;
}

// Channels without messages are part of what was recorded, too: also when the writer is killed after this chunk.
void Writer::State::introduce_all() {
  for (; next_to_introduce < is_introduced.size(); ++next_to_introduce) introduce(static_cast<std::uint16_t>(next_to_introduce));
}

base::Result<void> Writer::State::close_chunk() {
  if (chunk.empty()) return {};
  introduce_all();
  const auto packed = compressor.compress(chunk, room);
  if (!packed) return failure.emplace(packed.error());
  const std::uint32_t chunk_crc = crc32(0, chunk);

  if (in_chunk.empty()) first = last = Time(0);  // channels alone: the format has no other times for a chunk without messages
  ChunkEntry entry;
  entry.first = first;
  entry.last = last;
  entry.start = written;
  entry.compression = to_text(options.compression);
  entry.compressed = packed->size();
  entry.uncompressed = chunk.size();

  head.clear();
  head.push_back(static_cast<char>(Opcode::chunk));
  put(head, static_cast<std::uint64_t>(8 + 8 + 8 + 4 + 4 + entry.compression.size() + 8 + packed->size()));
  put(head, first);
  put(head, last);
  put(head, entry.uncompressed);
  put(head, chunk_crc);
  put_text(head, entry.compression);
  put(head, entry.compressed);
  entry.length = head.size() + packed->size();
  const std::uint32_t packed_crc = options.compression == Compression::none ? chunk_crc : crc32(0, *packed);
  if (const auto appended = append_chunk(*packed, packed_crc); !appended) return appended;

  std::string index;
  std::sort(in_chunk.begin(), in_chunk.end());
  entry.index_offsets.reserve(in_chunk.size());
  for (const std::uint16_t channel : in_chunk) {
    entry.index_offsets.emplace_back(channel, written + index.size());
    auto& entries = indexes[channel];
    const auto is_earlier = [](const IndexEntry& a, const IndexEntry& b) { return a.time < b.time; };
    if (!std::is_sorted(entries.begin(), entries.end(), is_earlier)) std::stable_sort(entries.begin(), entries.end(), is_earlier);
    index.push_back(static_cast<char>(Opcode::message_index));
    put(index, static_cast<std::uint64_t>(2 + 4 + 16 * entries.size()));
    put(index, channel);
    put(index, static_cast<std::uint32_t>(16 * entries.size()));
    for (const IndexEntry& one : entries) {
      put(index, one.time);
      put(index, one.offset);
    }
    entries.clear();
  }
  entry.index_length = index.size();
  if (const auto appended = append(index); !appended) return appended;
  summary.chunks.push_back(std::move(entry));
  ++summary.statistics.chunks;
  in_chunk.clear();
  chunk.clear();
  return {};
}

base::Result<void> Writer::State::finish() {
  if (is_closed) return failure ? base::Result<void>(*failure) : base::Result<void>();
  is_closed = true;
  introduce_all();
  if (const auto done = close_chunk(); !done) return done;
  return append(end_of_file(summary, written, crc));
}

Writer::Writer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&& other) noexcept {
  std::swap(state_, other.state_);
  return *this;
}

Writer::~Writer() {
  if (state_) (void)state_->finish();
}

base::Result<Writer> Writer::create(const std::string& path, const WriterOptions& options) {
  auto file = File::create(path);
  if (!file) return file.error();
  auto state = std::make_unique<State>(std::move(*file), options);
  state->is_schema_introduced.resize(1);
  state->indexes.resize(1);
  state->counts.resize(1);
  state->is_introduced.resize(1);
  if (const auto done = state->begin(); !done) return done.error();
  return Writer(std::move(state));
}

base::Result<std::uint16_t> Writer::add_schema(std::string name, std::string encoding, std::string data) {
  if (state_->failure) return *state_->failure;
  auto& schemas = state_->summary.schemas;
  if (schemas.size() >= most)
    return base::Error{state_->file.path() + ": schema " + base::in_quotes(name) + " is one too many; at most 65535"};
  const auto id = static_cast<std::uint16_t>(schemas.size() + 1);
  schemas[id] = Schema{id, std::move(name), std::move(encoding), std::move(data)};
  state_->is_schema_introduced.push_back(false);
  ++state_->summary.statistics.schemas;
  return id;
}

base::Result<std::uint16_t> Writer::add_channel(std::uint16_t schema, std::string topic, std::string encoding, Texts metadata) {
  if (state_->failure) return *state_->failure;
  Summary& summary = state_->summary;
  const auto error = [&](const std::string& what) {
    return base::Error{state_->file.path() + ": channel " + base::in_quotes(topic) + what};
  };
  if (summary.channels.size() >= most) return error(" is one too many; at most 65535");
  if (schema != 0 && !summary.schemas.contains(schema)) return error(" has the schema " + std::to_string(schema) + ", which was not added");
  const auto id = static_cast<std::uint16_t>(summary.channels.size() + 1);
  summary.channels[id] = Channel{id, schema, std::move(topic), std::move(encoding), std::move(metadata)};
  state_->is_introduced.push_back(false);
  state_->indexes.emplace_back();
  state_->counts.push_back(nullptr);
  ++summary.statistics.channels;
  return id;
}

base::Result<void> Writer::write(const Message& message) {
  State& state = *state_;
  if (state.failure) return *state.failure;
  if (message.channel == 0 || message.channel >= state.indexes.size()) {
    return base::Error{state.file.path() + ": message of channel " + std::to_string(message.channel) + ", which was not added"};
  }
  state.introduce(message.channel);
  auto& index = state.indexes[message.channel];
  if (index.empty()) state.in_chunk.push_back(message.channel);
  const bool is_first = state.in_chunk.size() == 1 && index.empty();
  state.first = is_first ? message.log_time : std::min(state.first, message.log_time);
  state.last = is_first ? message.log_time : std::max(state.last, message.log_time);
  index.push_back({message.log_time, state.chunk.size()});

  std::string& chunk = state.chunk;
  chunk.push_back(static_cast<char>(Opcode::message));
  put(chunk, static_cast<std::uint64_t>(message_head + message.data.size()));
  put(chunk, message.channel);
  put(chunk, message.sequence);
  put(chunk, message.log_time);
  put(chunk, message.publish_time);
  chunk.append(message.data);

  auto& counted = state.counts[message.channel];
  if (counted == nullptr) counted = &state.summary.statistics.messages_of[message.channel];
  count(state.summary.statistics, message, *counted);
  return chunk.size() >= state.options.chunk_size ? state.close_chunk() : base::Result<void>();
}

base::Result<void> Writer::attach(const Attachment& attachment) {
  if (const auto done = state_->close_chunk(); !done) return done;
  std::string content;
  put(content, attachment.log_time);
  put(content, attachment.create_time);
  put_text(content, attachment.name);
  put_text(content, attachment.media_type);
  put(content, static_cast<std::uint64_t>(attachment.data.size()));
  content.append(attachment.data);
  put(content, crc32(0, content));
  AttachmentPlace place{state_->written, record_head + content.size(), attachment.log_time, attachment.create_time, attachment.data.size(),
                        attachment.name, attachment.media_type};
  std::string record;
  put_record(record, Opcode::attachment, content);
  if (const auto done = state_->append(record); !done) return done;
  state_->summary.attachments.push_back(std::move(place));
  ++state_->summary.statistics.attachments;
  return {};
}

base::Result<void> Writer::add_metadata(const Metadata& metadata) {
  if (const auto done = state_->close_chunk(); !done) return done;
  std::string content;
  put_text(content, metadata.name);
  put_texts(content, metadata.texts);
  std::string record;
  put_record(record, Opcode::metadata, content);
  MetadataPlace place{state_->written, record.size(), metadata.name};
  if (const auto done = state_->append(record); !done) return done;
  state_->summary.metadata.push_back(std::move(place));
  ++state_->summary.statistics.metadata;
  return {};
}

base::Result<void> Writer::flush() {
  if (state_->failure) return *state_->failure;
  return state_->close_chunk();
}

base::Result<void> Writer::close() { return state_->finish(); }

std::uint64_t Writer::size() const { return state_->written + state_->chunk.size(); }
const Statistics& Writer::statistics() const { return state_->summary.statistics; }

}  // namespace mcap

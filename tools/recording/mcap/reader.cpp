#include <algorithm>
#include <deque>
#include <limits>
#include <set>
#include <utility>

#include "base/text.h"
#include "recording/mcap/compression.h"
#include "recording/mcap/scan.h"

namespace mcap {

namespace {

constexpr std::uint64_t max_octets = Reader::largest_chunk;  // of all chunks that are open at once
constexpr std::size_t max_places = 1'500'000;                // of messages in them; 36 MB, and twice that while they grow

// Where a message is: in a chunk's octets, or in the file.
struct Place {
  Time time{0};
  std::uint64_t offset = 0;  // [bytes] of the content
  std::uint64_t length = 0;  // [bytes]
};

// A chunk whose messages are being given; or all messages outside of chunks.
struct Cursor {
  const ChunkEntry* chunk = nullptr;
  std::vector<Place> places;  // in the order of time
  std::size_t next = 0;
  std::string octets;  // of the chunk; empty when others needed the room
  bool is_done() const { return next == places.size(); }
};

}  // namespace

struct Reader::State {
  State(File file_, Index index_) : file(std::move(file_)), index(std::move(index_)) {}

  void begin(Query new_query);
  base::Result<std::optional<Message>> next();

  bool is_wanted(std::uint16_t channel) const {
    return query.channels.empty() || std::count(query.channels.begin(), query.channels.end(), channel) != 0;
  }
  bool is_wanted(const ChunkEntry& chunk) const;
  bool is_wanted(const Message& message) const {
    return message.log_time >= query.from && message.log_time <= query.to && is_wanted(message.channel) &&
           index.summary.channels.contains(message.channel);
  }
  void open_loose();
  void note(const ChunkEntry& chunk, const base::Error& problem);
  base::Result<void> open_chunk(const ChunkEntry& chunk);
  base::Result<void> need_octets(Cursor& cursor);
  Cursor* earliest();

  File file;
  Index index;
  Query query;
  std::vector<const ChunkEntry*> chunks;  // wanted ones, in the order of their first time
  std::size_t next_chunk = 0;
  std::deque<Cursor> open;  // in the order of the file
  std::string loose;        // the content of one message outside of chunks
  bool leaves_out_broken = false;
  std::vector<BrokenChunk> broken;
  std::set<std::uint64_t> broken_starts;  // the same chunks
};

bool Reader::State::is_wanted(const ChunkEntry& chunk) const {
  if (chunk.last < query.from || chunk.first > query.to) return false;
  if (query.channels.empty() || chunk.channels.is_empty()) return true;
  return std::ranges::any_of(query.channels, [&](std::uint16_t channel) { return chunk.channels.contains(channel); });
}

void Reader::State::begin(Query new_query) {
  query = std::move(new_query);
  open.clear();
  chunks.clear();
  next_chunk = 0;
  for (const ChunkEntry& chunk : index.summary.chunks) {
    if (is_wanted(chunk)) chunks.push_back(&chunk);
  }
  std::stable_sort(chunks.begin(), chunks.end(), [](const ChunkEntry* a, const ChunkEntry* b) { return a->first < b->first; });
  open_loose();
}

void Reader::State::open_loose() {
  if (index.loose.empty()) return;
  Cursor cursor;
  for (const LooseMessage& message : index.loose) {
    if (message.time >= query.from && message.time <= query.to) {
      cursor.places.push_back({message.time, message.offset + record_head, message.length});
    }
  }
  std::stable_sort(cursor.places.begin(), cursor.places.end(), [](const Place& a, const Place& b) { return a.time < b.time; });
  if (!cursor.is_done()) open.push_back(std::move(cursor));
}

void Reader::State::note(const ChunkEntry& chunk, const base::Error& problem) {
  if (broken_starts.insert(chunk.start).second) broken.push_back({chunk.first, chunk.last, problem.message});
}

base::Result<void> Reader::State::open_chunk(const ChunkEntry& chunk) {
  Cursor cursor;
  cursor.chunk = &chunk;
  if (const auto done = need_octets(cursor); !done) return done;
  const auto walked = for_each_record(cursor.octets, [&](Opcode opcode, std::string_view content, std::uint64_t offset) {
    if (opcode != Opcode::message) return;
    const auto message = take_message(content);
    if (cursor.places.size() > max_places || !message || !is_wanted(*message)) return;
    cursor.places.push_back({message->log_time, offset, content.size()});
  });
  if (!walked)
    return base::Error{base::in_quotes(file.path()) + ": in the chunk at octet " + std::to_string(chunk.start) + ": " +
                       walked.error().message};
  std::size_t places = cursor.places.size();
  for (const Cursor& other : open) places += other.places.size();
  if (places > max_places) {
    return base::Error{base::in_quotes(file.path()) + ": more than " + std::to_string(max_places) +
                       " messages in chunks of one time are not read; the chunk at octet " + std::to_string(chunk.start) + " is left out"};
  }
  const auto is_earlier = [](const Place& a, const Place& b) { return a.time < b.time; };
  if (!std::ranges::is_sorted(cursor.places, is_earlier)) std::ranges::stable_sort(cursor.places, is_earlier);
  if (cursor.is_done()) return {};
  const auto behind = std::find_if(open.begin(), open.end(),
                                   [&](const Cursor& other) { return other.chunk != nullptr && other.chunk->start > chunk.start; });
  open.insert(behind, std::move(cursor));
  return {};
}

// Chunks that lie over each other in time are open together; when they are too large for that, they are decompressed again and again.
base::Result<void> Reader::State::need_octets(Cursor& cursor) {
  if (cursor.chunk == nullptr || !cursor.octets.empty()) return {};
  std::uint64_t taken = cursor.chunk->uncompressed;
  for (Cursor& other : open) {
    if (&other == &cursor) continue;
    taken += other.octets.size();
    if (taken > max_octets) other.octets = std::string();
  }
  return read_chunk(file, cursor.chunk->start, cursor.chunk->length, cursor.octets);
}

// Of equal times the one that stands first in the file.
Cursor* Reader::State::earliest() {
  Cursor* found = nullptr;
  for (Cursor& cursor : open) {
    if (found == nullptr || cursor.places[cursor.next].time < found->places[found->next].time) found = &cursor;
  }
  return found;
}

base::Result<std::optional<Message>> Reader::State::next() {
  for (;;) {
    std::erase_if(open, [](const Cursor& cursor) { return cursor.is_done(); });
    Cursor* cursor = earliest();
    while (next_chunk < chunks.size() && (cursor == nullptr || chunks[next_chunk]->first <= cursor->places[cursor->next].time)) {
      const ChunkEntry& chunk = *chunks[next_chunk++];
      if (const auto opened = open_chunk(chunk); !opened) {
        if (!leaves_out_broken) return opened.error();
        note(chunk, opened.error());
      }
      cursor = earliest();
    }
    if (cursor == nullptr) return std::optional<Message>();
    const Place place = cursor->places[cursor->next++];
    if (cursor->chunk == nullptr) {
      if (const auto done = file.read(place.offset, place.length, loose); !done) return done.error();
      const auto message = take_message(loose);
      if (message && is_wanted(*message)) return message;
      continue;
    }
    if (const auto done = need_octets(*cursor); !done) return done.error();
    if (place.offset > cursor->octets.size() || place.length > cursor->octets.size() - place.offset) {
      return base::Error{base::in_quotes(file.path()) + ": changes while it is read"};
    }
    return take_message(std::string_view(cursor->octets).substr(place.offset, place.length));
  }
}

Reader::Reader(std::unique_ptr<State> state) : state_(std::move(state)) {}
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;
Reader::~Reader() = default;

base::Result<Reader> Reader::open(const std::string& path) {
  auto file = File::open(path);
  if (!file) return file.error();
  auto index = read_index(*file);
  if (!index) return index.error();
  auto state = std::make_unique<State>(std::move(*file), std::move(*index));
  state->begin({});
  return Reader(std::move(state));
}

const std::string& Reader::profile() const { return state_->index.profile; }
const std::string& Reader::library() const { return state_->index.library; }
const std::map<std::uint16_t, Schema>& Reader::schemas() const { return state_->index.summary.schemas; }
const std::map<std::uint16_t, Channel>& Reader::channels() const { return state_->index.summary.channels; }
const Statistics& Reader::statistics() const { return state_->index.summary.statistics; }
const std::optional<std::string>& Reader::damage() const { return state_->index.damage; }

std::vector<Reader::AttachmentEntry> Reader::attachments() const {
  std::vector<AttachmentEntry> entries;
  for (const AttachmentPlace& place : state_->index.summary.attachments) {
    entries.push_back({place.name, place.media_type, place.size, place.log_time});
  }
  return entries;
}

base::Result<Attachment> Reader::attachment(const std::string& name) {
  const auto& places = state_->index.summary.attachments;
  const auto place = std::find_if(places.begin(), places.end(), [&](const AttachmentPlace& one) { return one.name == name; });
  if (place == places.end()) {
    return base::Error{base::in_quotes(state_->file.path()) + ": has no attachment " + base::in_quotes(name)};
  }
  return attachment(static_cast<std::size_t>(place - places.begin()));
}

base::Result<Attachment> Reader::attachment(std::size_t number) {
  const AttachmentPlace* place = &state_->index.summary.attachments.at(number);
  const std::string& path = state_->file.path();
  const std::string& name = place->name;
  std::string octets;
  if (const auto done = state_->file.read(place->start, place->length, octets); !done) return done.error();
  const auto wrong = [&](const char* what) {
    return base::Error{base::in_quotes(path) + ": octet " + std::to_string(place->start) + ": the attachment " + base::in_quotes(name) +
                       " " + what};
  };
  Octets in(octets);
  const auto opcode = static_cast<Opcode>(in.number<std::uint8_t>());
  (void)in.number<std::uint64_t>();
  if (opcode != Opcode::attachment || octets.size() < record_head + sizeof(std::uint32_t)) return wrong("is not where the summary says");
  const std::string_view content = in.rest();
  Attachment attachment;
  attachment.log_time = in.time();
  attachment.create_time = in.time();
  attachment.name = in.text();
  attachment.media_type = in.text();
  attachment.data = in.long_text();
  const auto crc = in.number<std::uint32_t>();
  if (!in.ok()) return wrong("is cut off");
  if (crc != 0 && crc32(0, content.substr(0, content.size() - in.rest().size() - sizeof crc)) != crc)
    return wrong("does not match its CRC");
  return attachment;
}

base::Result<std::vector<Metadata>> Reader::metadata() {
  std::vector<Metadata> all;
  std::uint64_t total = 0;
  for (std::size_t n = 0; n < metadata_count(); ++n) {
    total += state_->index.summary.metadata[n].length;
    if (total > max_descriptions)
      return base::Error{base::in_quotes(state_->file.path()) + ": metadata of more than " + std::to_string(max_descriptions) +
                         " bytes are not read"};
    auto one = metadata(n);
    if (!one) return one.error();
    all.push_back(std::move(*one));
  }
  return all;
}

std::size_t Reader::metadata_count() const { return state_->index.summary.metadata.size(); }

base::Result<Metadata> Reader::metadata(std::size_t number) {
  const MetadataPlace& place = state_->index.summary.metadata.at(number);
  std::string octets;
  if (place.length > max_descriptions) return at(state_->file, place.start, "metadata are longer than any are");
  if (const auto done = state_->file.read(place.start, place.length, octets); !done) return done.error();
  Octets in(octets);
  const auto opcode = static_cast<Opcode>(in.number<std::uint8_t>());
  (void)in.number<std::uint64_t>();
  Metadata metadata{std::string(in.text()), in.texts()};
  if (opcode != Opcode::metadata || !in.ok()) return at(state_->file, place.start, "expected metadata");
  return metadata;
}

Reader::Unread Reader::unread() const {
  const Broken& broken = state_->index.broken;
  return {broken.octets + state_->index.cut_off, broken.messages, broken.are_counted && state_->index.cut_off == 0};
}

std::uint64_t Reader::uncompressed() const {
  std::uint64_t octets = 0;
  for (const ChunkEntry& chunk : state_->index.summary.chunks) {
    if (chunk.uncompressed <= largest_chunk) octets += chunk.uncompressed;  // larger ones are not read
  }
  return octets;
}

bool Reader::for_each_time(const std::function<void(std::uint16_t, Time)>& take) const {
  std::vector<const ChunkEntry*> chunks;
  for (const ChunkEntry& chunk : state_->index.summary.chunks) chunks.push_back(&chunk);
  std::ranges::stable_sort(chunks, {}, &ChunkEntry::first);
  std::map<std::uint16_t, std::uint64_t> counts;
  std::string octets;
  for (const ChunkEntry* chunk : chunks) {
    if (chunk->index_length > max_octets || !state_->file.read(chunk->start + chunk->length, chunk->index_length, octets)) return false;
    bool is_whole = true;
    const auto walked = for_each_record(octets, [&](Opcode opcode, std::string_view content, std::uint64_t) {
      Octets in(content);
      const auto channel = in.number<std::uint16_t>();
      Octets entries = in.part(in.number<std::uint32_t>());
      while (is_whole && !entries.is_empty()) {
        const Time time = entries.time();
        (void)entries.number<std::uint64_t>();  // where it is
        is_whole = entries.ok();
        if (!is_whole) return;
        ++counts[channel];
        take(channel, time);
      }
      is_whole = is_whole && opcode == Opcode::message_index && in.ok();
    });
    if (!walked || !is_whole) return false;
  }
  auto expected = state_->index.summary.statistics.messages_of;
  std::erase_if(expected, [](const auto& one) { return one.second == 0; });
  return !state_->index.damage && counts == expected;
}

void Reader::seek(Query query) { state_->begin(std::move(query)); }
base::Result<std::optional<Message>> Reader::next() { return state_->next(); }
void Reader::leave_out_broken_chunks() { state_->leaves_out_broken = true; }
const std::vector<Reader::BrokenChunk>& Reader::broken_chunks() const { return state_->broken; }

}  // namespace mcap

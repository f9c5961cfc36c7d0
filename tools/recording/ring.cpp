#include "recording/ring.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/plain_file.h"
#include "base/text.h"
#include "recording/mcap/bytes.h"
#include "recording/mcap/file.h"

namespace recorder {

namespace fs = std::filesystem;

namespace {

constexpr const char* record_name = "ring";
constexpr std::size_t max_held = 256 << 20;  // [bytes] of latched samples

std::uint64_t number_at(const mcap::Texts& texts, const char* key) {
  const auto found = texts.find(key);
  return found == texts.end() ? 0 : static_cast<std::uint64_t>(std::max<std::int64_t>(0, base::parse_integer(found->second).value_or(0)));
}

// An error when the file is none, or none that can be read.
base::Result<RingSegment> read_segment(const std::string& path) {
  auto reader = mcap::Reader::open(path);
  if (!reader) return reader.error();
  for (std::size_t n = 0; n < reader->metadata_count(); ++n) {
    const auto one = reader->metadata(n);
    if (!one || one->name != record_name) continue;
    const auto compression = one->texts.find("compression");
    return RingSegment{path, number_at(one->texts, "number"), number_at(one->texts, "resets"),
                       std::chrono::nanoseconds(number_at(one->texts, "span_ns")),
                       compression == one->texts.end() ? "zstd" : compression->second};
  }
  return base::Error{base::in_quotes(path) + ": is not marked as a segment of a ring recording"};
}

// The files with names of segments, by the numbers in these.
std::map<std::uint64_t, std::string> files_with_numbers(const std::string& path) {
  const fs::path whole(path);
  const fs::path folder = whole.parent_path();
  const std::string head = whole.stem().string() + "-";
  std::map<std::uint64_t, std::string> files;
  std::error_code error;  // a folder that cannot be read has none
  for (fs::directory_iterator one(folder.empty() ? fs::path(".") : folder, error), end; !error && one != end; one.increment(error)) {
    const std::string name = one->path().filename().string();
    if (!name.starts_with(head) || one->path().extension() != whole.extension()) continue;
    const auto number = base::parse_integer(one->path().stem().string().substr(head.size()));
    const std::string file = (folder / name).string();
    if (!number || *number < 1 || numbered_path(path, static_cast<std::size_t>(*number)) != file) continue;
    files[static_cast<std::uint64_t>(*number)] = file;
  }
  return files;
}

// Puts messages of the segments into one file.
class RingMerge {
 public:
  RingMerge(mcap::Writer& writer, mcap::Time from) : writer_(writer), from_(from) {}

  base::Result<void> describe(const mcap::Reader& segment);
  base::Result<void> copy(mcap::Reader& segment, const std::string& path);
  // What could not be read, a line for each segment.
  const std::vector<std::string>& losses() const { return losses_; }
  std::uint64_t samples_lost() const { return samples_lost_; }

 private:
  // The number and the time of a sample tell it from a repetition, with which each segment begins.
  using Mark = std::pair<std::uint32_t, mcap::Time>;
  struct Held {
    mcap::Message message;
    std::string data;
  };

  base::Result<void> take(const mcap::Message& message);
  base::Result<void> hold(std::uint16_t channel, const mcap::Message& message);
  base::Result<void> put_held();
  base::Result<void> put(std::uint16_t channel, const mcap::Message& message, std::string_view data, mcap::Time time);
  void note_losses(const mcap::Reader& segment, const std::string& path, std::uint64_t read, const std::optional<std::string>& damage);

  mcap::Writer& writer_;
  const mcap::Time from_;
  std::optional<mcap::Time> first_;  // that was kept
  std::vector<std::string> losses_;
  std::uint64_t samples_lost_ = 0;
  std::map<std::pair<std::string, std::uint16_t>, std::uint16_t> known_;  // by topic and number in the segments, which all give it the same
  std::map<std::pair<std::string, std::string>, std::uint16_t> schemas_;  // by name and text
  std::map<std::uint16_t, std::uint16_t> ids_;                            // of the segment that is copied
  std::set<std::uint16_t> latched_;                                       // by their new numbers, as all below
  std::map<std::uint16_t, Held> held_;
  std::size_t held_octets_ = 0;
  std::map<std::uint16_t, Mark> seen_;
};

base::Result<void> RingMerge::describe(const mcap::Reader& segment) {
  ids_.clear();
  for (const auto& [id, channel] : segment.channels()) {
    auto& known = known_[{channel.topic, id}];
    if (known == 0) {
      const auto schema = segment.schemas().find(channel.schema);
      std::uint16_t new_schema = 0;
      if (schema != segment.schemas().end()) {
        auto& one = schemas_[{schema->second.name, schema->second.data}];
        if (one == 0) {
          const auto added = writer_.add_schema(schema->second.name, schema->second.encoding, schema->second.data);
          if (!added) return added.error();
          one = *added;
        }
        new_schema = one;
      }
      const auto added = writer_.add_channel(new_schema, channel.topic, channel.encoding, channel.metadata);
      if (!added) return added.error();
      known = *added;
      if (channel.metadata.contains("latched")) latched_.insert(known);
    }
    ids_[id] = known;
  }
  return {};
}

base::Result<void> RingMerge::put(std::uint16_t channel, const mcap::Message& message, std::string_view data, mcap::Time time) {
  return writer_.write({channel, message.sequence, time, message.publish_time, data});
}

// What held before the time that is kept still holds in it.
base::Result<void> RingMerge::put_held() {
  held_octets_ = 0;
  for (const auto& [channel, held] : std::exchange(held_, {})) {
    if (const auto done = put(channel, held.message, held.data, std::max(held.message.log_time, *first_)); !done) return done;
  }
  return {};
}

base::Result<void> RingMerge::hold(std::uint16_t channel, const mcap::Message& message) {
  Held& held = held_[channel];
  held_octets_ += message.data.size();
  held_octets_ -= held.data.size();
  if (held_octets_ > max_held)
    return base::Error{"what holds in a ring is more than " + std::to_string(max_held >> 20) + " MiB, which is not put together"};
  held = {message, std::string(message.data)};
  return {};
}

base::Result<void> RingMerge::take(const mcap::Message& message) {
  const auto channel = ids_.at(message.channel);
  if (latched_.contains(channel)) {
    const Mark mark{message.sequence, message.publish_time};
    if (const auto [seen, is_first] = seen_.try_emplace(channel, mark); !is_first && std::exchange(seen->second, mark) == mark) return {};
    if (message.log_time < from_) return hold(channel, message);
  }
  if (message.log_time < from_) return {};
  if (!first_) first_ = message.log_time;
  if (const auto done = put_held(); !done) return done;
  return put(channel, message, message.data, message.log_time);
}

// An end that is missing costs nothing: a kill leaves it so.
void RingMerge::note_losses(const mcap::Reader& segment, const std::string& path, std::uint64_t read,
                            const std::optional<std::string>& damage) {
  const auto unread = segment.unread();
  const std::uint64_t told = segment.statistics().messages;
  const std::uint64_t samples = unread.messages + told - std::min(told, read);
  if (!damage && samples == 0 && unread.octets == 0) return;
  std::string line = base::in_quotes(path) + ": not all can be read:";
  if (samples > 0) line += " " + std::to_string(samples) + " samples are lost;";
  if (unread.octets > 0) line += " " + std::to_string(unread.octets) + " bytes are lost;";
  samples_lost_ += samples;
  losses_.push_back(line + " " + damage.value_or(segment.damage().value_or("it has fewer samples than its summary lists")));
}

// What of a segment cannot be read is left out and told.
base::Result<void> RingMerge::copy(mcap::Reader& segment, const std::string& path) {
  if (const auto done = describe(segment); !done) return done;
  std::optional<std::string> damage;
  for (std::uint64_t read = 0;; ++read) {
    auto message = segment.next();
    for (; !message; message = segment.next()) {
      if (!damage) damage = message.error().message;
    }
    if (!message->has_value()) {
      note_losses(segment, path, read, damage);
      return first_ ? put_held() : base::Result<void>();
    }
    if (const auto done = take(**message); !done) return done;
  }
}

// Each segment has all of them; what cannot be read of the newest one is told.
base::Result<void> copy_surroundings(mcap::Reader& segment, mcap::Writer& writer, std::vector<std::string>& losses) {
  for (std::size_t n = 0; n < segment.metadata_count(); ++n) {
    const auto one = segment.metadata(n);
    if (!one) losses.push_back(one.error().message);
    if (!one || one->name == record_name) continue;
    if (const auto done = writer.add_metadata(*one); !done) return done;
  }
  for (std::size_t n = 0; n < segment.attachments().size(); ++n) {
    const auto attachment = segment.attachment(n);
    if (!attachment) {
      losses.push_back(attachment.error().message);
    } else if (const auto done = writer.attach(*attachment); !done) {
      return done;
    }
  }
  return {};
}

// A file that a recorder has created and was killed before it wrote what it is a segment of: empty, or a few bytes of an MCAP file without
// its end. No sample is in it.
bool is_empty_segment(const std::string& path) {
  constexpr std::string_view magic = "\x89MCAP0\r\n";
  constexpr std::size_t most = 512;
  std::ifstream in(path, std::ios::binary);
  std::string bytes(most, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(most));
  bytes.resize(static_cast<std::size_t>(in.gcount()));
  if (bytes.size() == most) return false;
  return bytes.size() <= magic.size() ? magic.starts_with(bytes) : bytes.starts_with(magic) && !bytes.ends_with(magic);
}

// Files that stand where the ring had another segment: only the two latest are there, so that it is next to the others.
std::vector<std::string> left_out(const std::string& path, const std::vector<RingSegment>& segments) {
  std::vector<std::string> lines;
  for (const auto& [number, file] : files_with_numbers(path)) {
    if (number + 1 < segments.front().number || number > segments.back().number + 1) continue;
    if (const auto segment = read_segment(file); !segment) lines.push_back(segment.error().message + "; it is left out");
  }
  return lines;
}

}  // namespace

std::string numbered_path(const std::string& path, std::size_t number) {
  char text[24];
  std::snprintf(text, sizeof text, "-%03zu", number);
  const fs::path whole(path);
  return (whole.parent_path() / (whole.stem().string() + text + whole.extension().string())).string();
}

mcap::Metadata ring_metadata(const RingSegment& segment) {
  return {record_name,
          {{"span_ns", std::to_string(segment.span.count())},
           {"number", std::to_string(segment.number)},
           {"resets", std::to_string(segment.resets)},
           {"compression", segment.compression}}};
}

std::vector<RingSegment> ring_segments(const std::string& path) {
  std::vector<RingSegment> segments;
  for (const auto& [number, file] : files_with_numbers(path)) {
    if (auto segment = read_segment(file)) segments.push_back(std::move(*segment));
  }
  std::ranges::stable_sort(segments, {}, &RingSegment::number);
  return segments;
}

base::Result<void> check_names(const std::string& path) {
  for (const auto& [number, file] : files_with_numbers(path)) {
    if (!read_segment(file) && !is_empty_segment(file))
      return base::Error{base::in_quotes(file) +
                         ": is not a segment of a ring recording, but has a name that a segment of this one may take; " +
                         "give the ring another name"};
  }
  return {};
}

void remove_empty_segments(const std::string& path) {
  std::error_code ignored;  // a file that stays is written over
  for (const auto& [number, file] : files_with_numbers(path)) {
    if (is_empty_segment(file) && !mcap::File::is_being_written(file)) fs::remove(file, ignored);
  }
}

base::Result<void> check_no_live_ring(const std::string& path) {
  if (const auto at_rest = check_not_recording(ring_segments(path)); !at_rest) return at_rest;
  const fs::path whole(path);
  const std::string stem = whole.stem().string();
  const auto dash = stem.rfind('-');
  if (dash == std::string::npos) return {};
  const auto number = base::parse_integer(stem.substr(dash + 1));
  const std::string ring = (whole.parent_path() / (stem.substr(0, dash) + whole.extension().string())).string();
  if (!number || *number < 1 || numbered_path(ring, static_cast<std::size_t>(*number)) != whole.string()) return {};
  return check_not_recording(ring_segments(ring));
}

base::Result<void> check_not_recording(const std::vector<RingSegment>& segments) {
  for (const auto& segment : segments) {
    if (mcap::File::is_being_written(segment.path))
      return base::Error{base::in_quotes(segment.path) + ": is a segment of a ring that is still being recorded"};
  }
  return {};
}

void remove_ring_segments(const std::vector<RingSegment>& segments) {
  for (const auto& segment : segments) std::remove(segment.path.c_str());
}

std::string segment_names(const std::vector<RingSegment>& segments) {
  std::vector<std::string> names;
  for (const auto& segment : segments) names.push_back(base::in_quotes(segment.path));
  return base::join(names, " and ");
}

base::Result<MergedRing> merge_ring(const std::vector<RingSegment>& segments, const std::string& ring, const std::string& path) {
  if (segments.empty()) return base::Error{base::in_quotes(path) + ": has no segments of a ring"};
  std::vector<mcap::Reader> readers;
  std::vector<std::string> paths, losses = left_out(ring, segments);
  const RingSegment& newest = segments.back();
  for (const auto& segment : segments) {
    if (segment.resets != newest.resets) continue;  // its time is another one
    auto reader = mcap::Reader::open(segment.path);
    if (!reader) return reader.error();
    readers.push_back(std::move(*reader));
    paths.push_back(segment.path);
  }
  std::uint64_t last = 0;
  for (const auto& reader : readers) last = std::max(last, reader.statistics().last.count());
  const auto span = static_cast<std::uint64_t>(newest.span.count());
  const auto compression = newest.compression == "lz4"    ? mcap::Compression::lz4
                           : newest.compression == "none" ? mcap::Compression::none
                                                          : mcap::Compression::zstd;
  if (mcap::File::is_being_written(path)) return base::Error{base::in_quotes(path) + ": is being written by another process"};
  const std::string whole = path + ".part";
  const auto give_up = [&](const base::Error& error) {
    std::remove(whole.c_str());
    return error;
  };
  auto writer = mcap::Writer::create(whole, {.profile = "", .compression = compression});
  if (!writer) return writer.error();
  if (const auto done = copy_surroundings(readers.back(), *writer, losses); !done) return give_up(done.error());
  RingMerge merge(*writer, mcap::Time(last > span ? last - span : 0));
  for (std::size_t n = 0; n < readers.size(); ++n) {
    if (const auto done = merge.copy(readers[n], paths[n]); !done) return give_up(done.error());
  }
  if (const auto done = writer->close(); !done) return give_up(done.error());
  if (std::rename(whole.c_str(), path.c_str()) != 0)
    return give_up({base::in_quotes(path) + ": cannot be written: " + std::strerror(errno)});
  losses.insert(losses.end(), merge.losses().begin(), merge.losses().end());
  return MergedRing{writer->statistics().messages, writer->statistics().channels, merge.samples_lost(), std::move(losses)};
}

base::Result<mcap::Reader> open_recording(const std::string& path) {
  auto reader = mcap::Reader::open(path);
  std::error_code error;
  if (reader || fs::exists(path, error)) return reader;
  const auto segments = ring_segments(path);
  if (segments.empty()) return reader;
  return base::Error{base::in_quotes(path) + ": is not there, but " + segment_names(segments) + " of its ring; rtse recording repair " +
                     path + " puts them together"};
}

std::string recording_absence_problem(const std::string& path) {
  std::error_code error;
  if (fs::exists(path, error)) return "";
  const auto reader = open_recording(path);
  return reader ? "" : reader.error().message;
}

bool is_recording(const std::string& path) {
  std::string begin(mcap::magic.size(), '\0');
  if (base::is_plain_file(path)) std::ifstream(path, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == mcap::magic;
}

std::string recording_format_problem(const std::string& path) {
  if (is_recording(path)) return "";
  if (!ring_segments(path).empty()) return recording_absence_problem(path);
  if (const auto problem = base::file_problem(path); !problem.empty()) return "recording " + base::in_quotes(path) + ": " + problem;
  return base::in_quotes(path) + ": is not an MCAP file: it does not start with the magic bytes";
}

}  // namespace recorder

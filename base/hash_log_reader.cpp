// Reading, merging and comparing hash logs.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/guarded.h"
#include "base/hash_log.h"
#include "base/hash_log_format.h"
#include "base/text.h"

namespace base {
namespace {

constexpr std::uint64_t longest_name = 4096;
constexpr std::uint64_t max_entries = 1U << 20U;

std::span<const std::byte> octets_of(const std::string& text) { return std::as_bytes(std::span(text)); }

}  // namespace

std::string HashKey::text() const {
  switch (kind) {
    case Kind::world:
      return "world " + name;
    case Kind::model:
      return "model " + name;
    case Kind::device:
      return "device " + name;
    case Kind::component:
      return "component " + name;
    case Kind::in_port:
      return "port " + name + " (in)";
    case Kind::out_port:
      return "port " + name + " (out)";
  }
  return name;
}

Result<HashLogReader> HashLogReader::open(const std::string& path) {
  expect_no_data_held();
  std::ifstream file(path, std::ios::binary);
  if (!file) return Error{"hash log " + in_quotes(path) + ": " + std::strerror(errno)};
  std::string start(hash_log_format::magic.size(), '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  const std::string_view magic = hash_log_format::magic;
  const bool is_log = file && std::string_view(start).substr(0, magic.size() - 1) == magic.substr(0, magic.size() - 1);
  if (!is_log || start.back() < hash_log_format::oldest_version) return Error{"file " + in_quotes(path) + ": is no hash log"};
  const auto version = static_cast<unsigned>(start.back() - '0');
  if (start.back() > magic.back())
    return Error{"hash log " + in_quotes(path) + ": is of version " + std::to_string(version) + ", which is newer than this program"};
  HashLogReader reader(path, std::move(file));
  reader.version_ = version;
  return reader;
}

Error HashLogReader::damaged() const { return Error{"hash log " + in_quotes(path_) + ": is damaged after tick " + std::to_string(ticks_)}; }

std::optional<std::uint64_t> HashLogReader::number(unsigned octets) {
  std::uint64_t value = 0;
  for (unsigned i = 0; i < octets; ++i) {
    const int octet = file_.get();
    if (octet < 0) return std::nullopt;
    value |= static_cast<std::uint64_t>(octet) << (8 * i);
  }
  return value;
}

std::optional<std::uint64_t> HashLogReader::varint() {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64; shift += 7) {
    const int octet = file_.get();
    if (octet < 0) return std::nullopt;
    value |= static_cast<std::uint64_t>(octet & 0x7f) << shift;
    if ((octet & 0x80) == 0) return value;
  }
  return std::nullopt;
}

std::optional<std::string> HashLogReader::text(std::uint64_t most) {
  const auto size = varint();
  if (!size || *size > most) return std::nullopt;
  std::string text(*size, '\0');
  file_.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!file_) return std::nullopt;
  return text;
}

bool HashLogReader::read_key() {
  HashKey key;
  const auto kind = number(1);
  const auto phase = varint();
  auto name = text(longest_name), type = text(longest_name);
  if (!kind || *kind > static_cast<std::uint64_t>(HashKey::Kind::out_port) || !phase || !name || !type) return false;
  keys_.push_back({static_cast<HashKey::Kind>(*kind), static_cast<std::uint32_t>(*phase), std::move(*name), std::move(*type)});
  return true;
}

bool HashLogReader::read_tick(HashTick& tick) {
  const auto run = varint(), time = varint(), count = varint();
  if (!run || !time || !count || *count > max_entries) return false;
  tick.run = static_cast<std::uint32_t>(*run);
  tick.time = std::chrono::nanoseconds(static_cast<std::int64_t>(*time));
  tick.entries.clear();
  for (std::uint64_t i = 0; i < *count; ++i) {
    const auto key = varint(), hash = number(8);
    auto value = text(longest_hash_value);
    if (!key || *key >= keys_.size() || !hash || !value) return false;
    tick.entries.push_back({static_cast<std::uint32_t>(*key), *hash, std::move(*value)});
  }
  std::ranges::stable_sort(tick.entries, {}, [this](const HashEntry& entry) { return keys_[entry.key].order(); });
  return true;
}

Result<bool> HashLogReader::next(HashTick& tick) {
  while (true) {
    const int record = file_.get();
    if (record < 0) return false;
    if (record == hash_log_format::key_record) {
      if (!read_key()) return damaged();
    } else if (record == hash_log_format::tick_record) {
      if (!read_tick(tick)) {
        if (file_.eof()) return false;  // the run was ended in the middle of a tick
        return damaged();
      }
      ++ticks_;
      all_.add(std::uint64_t{tick.run});
      all_.add(static_cast<std::uint64_t>(tick.time.count()));
      for (const HashEntry& entry : tick.entries) all_.add(keys_[entry.key].name), all_.add(entry.hash);
      return true;
    } else if (record == hash_log_format::end_record) {
      const auto ticks = varint();
      if (!ticks || *ticks != ticks_ || file_.get() >= 0) return damaged();
      is_complete_ = true;
      return false;
    } else {
      return damaged();
    }
  }
}

namespace {

// A log with the tick that comes next.
struct Part {
  HashLogReader reader;
  HashTick tick{};
  bool is_over = false;

  Result<void> advance() {
    const auto is_there = reader.next(tick);
    if (!is_there) return is_there.error();
    is_over = !*is_there;
    return {};
  }
};

Result<std::vector<Part>> open_all(const std::vector<std::string>& paths) {
  std::vector<Part> parts;
  for (const auto& path : paths) {
    auto reader = HashLogReader::open(path);
    if (!reader) return reader.error();
    parts.push_back({std::move(*reader)});
    if (const auto done = parts.back().advance(); !done) return done.error();
  }
  return parts;
}

// Hashes of different versions say nothing about each other.
Result<void> same_version(const std::vector<Part>& parts, const std::vector<std::string>& paths) {
  for (std::size_t i = 1; i < parts.size(); ++i) {
    if (parts[i].reader.version() == parts[0].reader.version()) continue;
    return Error{"hash logs " + in_quotes(paths[0]) + " and " + in_quotes(paths[i]) + ": are of versions " +
                 std::to_string(parts[0].reader.version()) + " and " + std::to_string(parts[i].reader.version()) +
                 ", whose hashes differ for equal runs"};
  }
  return {};
}

}  // namespace

Result<void> merge_hash_logs(const std::vector<std::string>& paths, const std::string& path) {
  auto parts = open_all(paths);
  if (!parts) return parts.error();
  if (const auto same = same_version(*parts, paths); !same) return same.error();
  auto writer = HashLogWriter::create(path, parts->empty() ? hash_log_version : parts->front().reader.version());
  if (!writer) return writer.error();
  while (true) {
    const HashTick* first = nullptr;
    for (const Part& part : *parts) {
      if (!part.is_over && (!first || part.tick.when() < first->when())) first = &part.tick;
    }
    if (!first) break;
    const auto when = first->when();
    writer->begin_tick(when.first, when.second);
    for (Part& part : *parts) {
      while (!part.is_over && part.tick.when() == when) {
        for (const HashEntry& entry : part.tick.entries)
          writer->add(writer->key(part.reader.keys()[entry.key]), entry.hash, octets_of(entry.value));
        if (const auto done = part.advance(); !done) return done.error();
      }
    }
  }
  if (!writer->finish()) return Error{"hash log " + in_quotes(path) + ": cannot be written"};
  return {};
}

namespace {

// The leaves in which the tick differs, with both entries, in order.
std::vector<HashDifference> differences(const Part& a, const Part& b, bool has_a, bool has_b) {
  std::vector<HashDifference> found;
  const std::vector<HashEntry> none;
  const auto& left = has_a ? a.tick.entries : none;
  const auto& right = has_b ? b.tick.entries : none;
  const auto key_a = [&](std::size_t i) -> const HashKey& { return a.reader.keys()[left[i].key]; };
  const auto key_b = [&](std::size_t i) -> const HashKey& { return b.reader.keys()[right[i].key]; };
  std::size_t i = 0, j = 0;
  while (i < left.size() || j < right.size()) {
    const bool only_a = j == right.size() || (i < left.size() && key_a(i).order() < key_b(j).order());
    const bool only_b = !only_a && (i == left.size() || key_b(j).order() < key_a(i).order());
    if (only_a) {
      found.push_back({.key = key_a(i), .a = left[i], .b = {}});
    } else if (only_b) {
      found.push_back({.key = key_b(j), .a = {}, .b = right[j]});
    } else if (left[i].hash != right[j].hash) {
      found.push_back({.key = key_a(i), .a = left[i], .b = right[j]});
    }
    i += only_b ? 0 : 1;
    j += only_a ? 0 : 1;
  }
  return found;
}

}  // namespace

Result<HashComparison> compare_hash_logs(const std::string& path_a, const std::string& path_b) {
  auto parts = open_all({path_a, path_b});
  if (!parts) return parts.error();
  Part& a = (*parts)[0];
  Part& b = (*parts)[1];
  if (const auto same = same_version(*parts, {path_a, path_b}); !same) return same.error();
  HashComparison result;
  while (!a.is_over || !b.is_over) {
    const bool has_a = !a.is_over && (b.is_over || a.tick.when() <= b.tick.when());
    const bool has_b = !b.is_over && (a.is_over || b.tick.when() <= a.tick.when());
    auto found = differences(a, b, has_a, has_b);
    if (!found.empty()) {
      result.first = std::move(found.front());
      result.first->tick = result.ticks;
      const HashTick& tick = has_a ? a.tick : b.tick;
      std::tie(result.first->run, result.first->time) = tick.when();
      for (std::size_t i = 1; i < found.size(); ++i) result.others.push_back(std::move(found[i].key));
      return result;
    }
    ++result.ticks;
    result.hash = a.reader.hash();
    for (Part* part : {&a, &b}) {
      if (const auto done = part->advance(); !done) return done.error();
    }
  }
  result.is_complete_a = a.reader.is_complete();
  result.is_complete_b = b.reader.is_complete();
  return result;
}

}  // namespace base

// Writing hash logs.
#include "base/hash_log.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "base/guarded.h"
#include "base/hash_log_format.h"
#include "base/text.h"

namespace base {
namespace {

constexpr std::size_t flush_size = 1U << 16U;

constexpr std::size_t longest_varint = 10;

// Returns where it ends.
char* put_varint(char* out, std::uint64_t number) {
  for (; number >= 0x80; number >>= 7U) *out++ = static_cast<char>(number | 0x80U);
  *out++ = static_cast<char>(number);
  return out;
}

void put_varint(std::string& out, std::uint64_t number) {
  std::array<char, longest_varint> octets;
  out.append(octets.data(), put_varint(octets.data(), number));
}

void put_text(std::string& out, std::string_view text) {
  put_varint(out, text.size());
  out += text;
}

}  // namespace

Result<HashLogWriter> HashLogWriter::create(const std::string& path, unsigned version) {
  expect_no_data_held();
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (!file) return Error{"hash log " + in_quotes(path) + ": " + std::strerror(errno)};
  HashLogWriter writer(std::move(file));
  writer.out_ = hash_log_format::magic;
  writer.out_.back() = static_cast<char>('0' + version);
  return writer;
}

std::uint32_t HashLogWriter::key(const HashKey& key) {
  const auto [place, is_new] = known_.try_emplace({key.kind, key.name}, static_cast<std::uint32_t>(known_.size()));
  if (!is_new) return place->second;
  keys_ += hash_log_format::key_record;
  keys_ += static_cast<char>(key.kind);
  put_varint(keys_, key.phase);
  put_text(keys_, key.name);
  put_text(keys_, key.type);
  return place->second;
}

void HashLogWriter::expect() const {
  __builtin_prefetch(entries_.data(), 1);
  __builtin_prefetch(out_.data() + out_.size(), 1);
}

void HashLogWriter::begin_tick(std::uint32_t run, std::chrono::nanoseconds time) {
  end_tick();
  tick_.run = run;
  tick_.time = time;
}

// There are thousands of entries for each second of a run: their octets are put together here and appended at once.
void HashLogWriter::add(std::uint32_t key, std::uint64_t hash, std::span<const std::byte> value) {
  const auto kept = value.size() <= longest_hash_value ? value : std::span<const std::byte>();
  std::array<char, longest_varint + sizeof hash + longest_varint + longest_hash_value> octets;
  char* end = put_varint(octets.data(), key);
  for (unsigned i = 0; i < sizeof hash; ++i) *end++ = static_cast<char>(hash >> (8 * i));
  end = put_varint(end, kept.size());
  if (!kept.empty()) std::memcpy(end, kept.data(), kept.size());
  entries_.append(octets.data(), static_cast<std::size_t>(end - octets.data()) + kept.size());
  ++count_;
}

void HashLogWriter::end_tick() {
  if (count_ == 0) return;
  if (!keys_.empty()) out_ += std::exchange(keys_, {});
  std::array<char, 1 + 3 * longest_varint> head;
  head[0] = hash_log_format::tick_record;
  char* end = put_varint(head.data() + 1, tick_.run);
  end = put_varint(end, static_cast<std::uint64_t>(std::max<std::int64_t>(tick_.time.count(), 0)));
  end = put_varint(end, std::exchange(count_, 0));
  out_.append(head.data(), end);
  out_ += entries_;
  entries_.clear();
  ++ticks_;
  if (out_.size() >= flush_size) flush();
}

void HashLogWriter::flush() {
  expect_no_data_held();
  file_.write(out_.data(), static_cast<std::streamsize>(out_.size()));
  out_.clear();
}

bool HashLogWriter::finish() {
  end_tick();
  out_ += hash_log_format::end_record;
  put_varint(out_, ticks_);
  flush();
  file_.close();
  return static_cast<bool>(file_);
}

}  // namespace base

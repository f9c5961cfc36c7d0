// Hash logs: hashes of a run, tick by tick, as a tree of models, devices, components and ports. Two runs are equal if their logs
// are equal; otherwise the first difference names the tick and the leaf. The format is in docs/hash-logs.md. One thread at a
// time.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "base/hash64.h"
#include "base/result.h"

namespace base {

// A leaf of the tree. Port and component leaves have the phase of their component; the world's come before all phases.
struct HashKey {
  enum class Kind : std::uint8_t { world = 0, model = 1, device = 2, component = 3, in_port = 4, out_port = 5 };
  Kind kind = Kind::world;
  std::uint32_t phase = 0;
  std::string name;
  std::string type;  // of the value: a data type of ports; "pose" for models; may be empty

  bool is_world() const { return kind <= Kind::device; }
  // In the order in which things happen in a tick.
  auto order() const { return std::tuple(!is_world(), phase, std::string_view(name), kind); }
  // "component LaserObstacleAvoid0", "port RTCLaser0.range (out)"
  std::string text() const;
};

struct HashEntry {
  std::uint32_t key = 0;   // its place in HashLogReader::keys
  std::uint64_t hash = 0;  // of everything that happened there in the tick
  std::string value;       // octets: the last sample when it is short, a model's pose; may be empty
};

struct HashTick {
  std::uint32_t run = 0;  // counts the resets
  std::chrono::nanoseconds time{0};
  std::vector<HashEntry> entries;  // those leaves where something happened, by HashKey::order when they were read

  auto when() const { return std::pair(run, time); }
};

// Longer values are not kept.
inline constexpr std::size_t longest_hash_value = 256;

// Of what is hashed, and when: logs of different versions cannot be compared. All since version 1 can be read.
inline constexpr unsigned hash_log_version = 4;

// Of several samples of a tick, in their order. That of a single one is its own.
inline std::uint64_t chained(std::uint64_t before, std::uint64_t next) {
  Hash64 both;
  both.add(before);
  both.add(next);
  return both.value();
}

class HashLogWriter {
 public:
  // Another version: for entries that come from a log of that version.
  static Result<HashLogWriter> create(const std::string& path, unsigned version = hash_log_version);

  // The number of the leaf, for add().
  std::uint32_t key(const HashKey& key);
  // Ticks come in order. One ends by end_tick(), while what it has is at hand, or when the next one begins.
  void begin_tick(std::uint32_t run, std::chrono::nanoseconds time);
  void add(std::uint32_t key, std::uint64_t hash, std::span<const std::byte> value = {});
  void end_tick();
  // For who writes seldom: asks the processor for the memory that the next tick goes to. Does nothing else.
  void expect() const;
  // False when not all could be written. Without it readers take the log for one of a run that did not end.
  bool finish();

 private:
  explicit HashLogWriter(std::ofstream file) : file_(std::move(file)) {}
  void flush();

  std::ofstream file_;
  std::string out_, keys_;  // to be written; keys first
  HashTick tick_;
  std::string entries_;
  std::size_t count_ = 0;
  std::uint64_t ticks_ = 0;
  std::map<std::pair<HashKey::Kind, std::string>, std::uint32_t> known_;
};

class HashLogReader {
 public:
  // An error when it is no hash log, or of a later version.
  static Result<HashLogReader> open(const std::string& path);

  const std::vector<HashKey>& keys() const { return keys_; }
  // False at the end. An error names the octet from which on the file is damaged.
  Result<bool> next(HashTick& tick);
  unsigned version() const { return version_; }
  // The run came to its end; known when next() has said false.
  bool is_complete() const { return is_complete_; }
  // Of everything that was read so far: equal for equal runs.
  std::uint64_t hash() const { return all_.value(); }
  std::uint64_t ticks() const { return ticks_; }

 private:
  HashLogReader(std::string path, std::ifstream file) : path_(std::move(path)), file_(std::move(file)) {}
  Error damaged() const;
  std::optional<std::uint64_t> number(unsigned octets);
  std::optional<std::uint64_t> varint();
  std::optional<std::string> text(std::uint64_t most);
  bool read_key();
  bool read_tick(HashTick& tick);

  std::string path_;
  std::ifstream file_;
  std::vector<HashKey> keys_;
  Hash64 all_;
  std::uint64_t ticks_ = 0;
  unsigned version_ = hash_log_version;
  bool is_complete_ = false;
};

// Several logs of one run, by time, as one log.
Result<void> merge_hash_logs(const std::vector<std::string>& parts, const std::string& path);

struct HashDifference {
  std::uint64_t tick = 0;  // its number in the logs, from 0
  std::uint32_t run = 0;
  std::chrono::nanoseconds time{0};
  HashKey key;                    // empty name: only the lengths of the logs differ
  std::optional<HashEntry> a, b;  // nothing: nothing happened there in this tick
};

struct HashComparison {
  std::optional<HashDifference> first;
  std::vector<HashKey> others;                        // what else differs in the same tick
  std::uint64_t ticks = 0;                            // that are equal
  std::uint64_t hash = 0;                             // of the first log up to there
  bool is_complete_a = false, is_complete_b = false;  // when they are equal
};

Result<HashComparison> compare_hash_logs(const std::string& path_a, const std::string& path_b);

}  // namespace base

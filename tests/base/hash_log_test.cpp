#include "base/hash_log.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <set>

#include "base/text.h"

namespace base {
namespace {

using std::chrono::milliseconds;
using Kind = HashKey::Kind;

class HashLogs : public testing::Test {
 protected:
  HashLogs() { std::filesystem::create_directories(folder_); }
  ~HashLogs() override { std::filesystem::remove_all(folder_); }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  struct Event {
    int time_ms;
    HashKey key;
    std::uint64_t hash;
    std::uint32_t run = 0;
  };
  std::string write(const std::string& name, const std::vector<Event>& events) const {
    auto writer = HashLogWriter::create(file(name));
    EXPECT_TRUE(writer.ok());
    std::pair<std::uint32_t, int> when{0, -1};
    for (const Event& event : events) {
      if (std::pair(event.run, event.time_ms) != when) writer->begin_tick(event.run, milliseconds(event.time_ms));
      when = {event.run, event.time_ms};
      writer->add(writer->key(event.key), event.hash);
    }
    EXPECT_TRUE(writer->finish());
    return file(name);
  }

 private:
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      ("hash-log-test-" + std::to_string(getpid()) + "-" + testing::UnitTest::GetInstance()->current_test_info()->name());
};

const HashKey model{Kind::model, 0, "robot", "pose"};
const HashKey laser{Kind::out_port, 0, "Laser0:range", "IDL:RTC/RangeData:1.0"};
const HashKey sensor_of_phase_1{Kind::out_port, 1, "Avoid0:velocity", ""};

TEST_F(HashLogs, a_log_reads_back_as_it_was_written) {
  {
    auto writer = HashLogWriter::create(file("a"));
    ASSERT_TRUE(writer.ok());
    writer->begin_tick(0, milliseconds(10));
    const std::byte value[] = {std::byte{1}, std::byte{2}};
    writer->add(writer->key(laser), 0x0123456789abcdef, value);
    writer->begin_tick(2, milliseconds(0));
    ASSERT_TRUE(writer->finish());
  }
  auto log = HashLogReader::open(file("a"));
  ASSERT_TRUE(log.ok());
  HashTick tick;
  ASSERT_TRUE(*log->next(tick));
  EXPECT_EQ(tick.time, milliseconds(10));
  ASSERT_EQ(tick.entries.size(), 1U);
  EXPECT_EQ(tick.entries[0].hash, 0x0123456789abcdef);
  EXPECT_EQ(tick.entries[0].value, std::string("\1\2"));
  EXPECT_EQ(log->keys()[0].text(), "port Laser0:range (out)");
  EXPECT_FALSE(*log->next(tick)) << "a tick in which nothing happened is none";
  EXPECT_TRUE(log->is_complete());
}

TEST_F(HashLogs, equal_runs_have_no_difference) {
  const auto a = write("a", {{0, model, 1}, {10, laser, 2}}), b = write("b", {{0, model, 1}, {10, laser, 2}});
  const auto comparison = compare_hash_logs(a, b);
  ASSERT_TRUE(comparison.ok());
  EXPECT_FALSE(comparison->first);
  EXPECT_EQ(comparison->ticks, 2U);
  EXPECT_TRUE(comparison->is_complete_a && comparison->is_complete_b);
}

TEST_F(HashLogs, the_first_difference_is_the_one_that_happened_first_in_the_tick) {
  const auto a = write("a", {{0, model, 1}, {10, sensor_of_phase_1, 2}, {10, laser, 3}});
  const auto b = write("b", {{0, model, 1}, {10, sensor_of_phase_1, 7}, {10, laser, 8}});
  const auto comparison = compare_hash_logs(a, b);
  ASSERT_TRUE(comparison.ok() && comparison->first);
  EXPECT_EQ(comparison->first->key.name, laser.name);
  EXPECT_EQ(comparison->first->time, milliseconds(10));
  EXPECT_EQ(comparison->first->tick, 1U);
  EXPECT_EQ(comparison->first->b->hash, 8U);
  ASSERT_EQ(comparison->others.size(), 1U);
  EXPECT_EQ(comparison->others[0].name, sensor_of_phase_1.name);
}

TEST_F(HashLogs, what_happened_in_one_run_only_is_a_difference) {
  const auto a = write("a", {{0, model, 1}, {10, laser, 2}, {20, laser, 2}}), b = write("b", {{0, model, 1}, {20, laser, 2}});
  const auto comparison = compare_hash_logs(a, b);
  ASSERT_TRUE(comparison.ok() && comparison->first);
  EXPECT_EQ(comparison->first->time, milliseconds(10));
  EXPECT_TRUE(comparison->first->a && !comparison->first->b);
}

TEST_F(HashLogs, parts_of_a_run_become_one_log_by_time_and_reset) {
  const auto world = write("world", {{0, model, 1}, {20, model, 2}, {0, model, 3, 1}}),
             ports = write("ports", {{0, laser, 4}, {10, laser, 5}});
  ASSERT_TRUE(merge_hash_logs({ports, world}, file("whole")).ok());
  const auto expected = write("expected", {{0, model, 1}, {0, laser, 4}, {10, laser, 5}, {20, model, 2}, {0, model, 3, 1}});
  const auto comparison = compare_hash_logs(file("whole"), expected);
  ASSERT_TRUE(comparison.ok());
  EXPECT_FALSE(comparison->first);
  EXPECT_EQ(comparison->ticks, 4U);
}

TEST_F(HashLogs, a_log_that_was_cut_is_of_a_run_that_did_not_end) {
  const auto a = write("a", {{0, model, 1}, {10, laser, 2}});
  for (auto size = std::filesystem::file_size(a) - 1; size > 8; --size) {
    std::filesystem::resize_file(a, size);
    auto log = HashLogReader::open(a);
    ASSERT_TRUE(log.ok());
    HashTick tick;
    while (true) {
      const auto is_there = log->next(tick);
      if (!is_there || !*is_there) break;
    }
    EXPECT_FALSE(log->is_complete());
  }
}

TEST_F(HashLogs, what_is_no_hash_log_or_is_damaged_is_named) {
  std::ofstream(file("text")) << "hello, this is text";
  EXPECT_EQ(HashLogReader::open(file("text")).error().message, "file " + in_quotes(file("text")) + ": is no hash log");
  const auto a = write("a", {{0, model, 1}});
  std::fstream(a, std::ios::in | std::ios::out | std::ios::binary).seekp(8).put('\x7f');
  HashTick tick;
  auto log = HashLogReader::open(a);
  ASSERT_TRUE(log.ok());
  EXPECT_EQ(log->next(tick).error().message, "hash log " + in_quotes(a) + ": is damaged after tick 0");
}

TEST_F(HashLogs, logs_of_other_versions_are_read_and_compared_with_their_like_only) {
  const auto as_version = [&](const std::string& path, char version) {
    std::fstream(path, std::ios::in | std::ios::out | std::ios::binary).seekp(7).put(version);
    return path;
  };
  const auto c = write("c", {{0, model, 1}});
  for (const char version : {'1', '2', '3'}) {
    const auto a = as_version(write("a", {{0, model, 1}}), version), b = as_version(write("b", {{0, model, 1}}), version);
    ASSERT_TRUE(compare_hash_logs(a, b).ok());
    EXPECT_FALSE(compare_hash_logs(a, b)->first);
    EXPECT_EQ(compare_hash_logs(a, c).error().message, "hash logs " + in_quotes(a) + " and " + in_quotes(c) + ": are of versions " +
                                                           version + " and 4, whose hashes differ for equal runs");
    ASSERT_TRUE(merge_hash_logs({a}, file("whole")).ok());
    EXPECT_EQ(HashLogReader::open(file("whole"))->version(), static_cast<unsigned>(version - '0'));
  }
  EXPECT_EQ(HashLogReader::open(as_version(c, '5')).error().message,
            "hash log " + in_quotes(c) + ": is of version 5, which is newer than this program");
  EXPECT_EQ(HashLogReader::open(as_version(c, '0')).error().message, "file " + in_quotes(c) + ": is no hash log");
}

TEST(Hash64, tells_words_that_changed_places) {
  const auto hash_of = [](std::initializer_list<std::uint64_t> words) {
    Hash64 hash;
    for (const std::uint64_t word : words) hash.add(word);
    return hash.value();
  };
  EXPECT_NE(hash_of({1, 0, 0, 0}), hash_of({0, 1, 0, 0}));
  EXPECT_NE(hash_of({1, 2, 3, 4, 5, 6, 7, 8}), hash_of({5, 2, 3, 4, 1, 6, 7, 8}));
  EXPECT_NE(hash_of({0, 0}), hash_of({0, 0, 0}));
  EXPECT_NE(hash_of({}), hash_of({0}));
}

// Small numbers in the other words: none of them may make one go unseen.
TEST(Hash64, tells_each_word_beside_small_ones) {
  for (const std::size_t size : {1, 7, 8, 9, 16, 24}) {
    for (std::uint64_t small = 0; small <= 64; ++small) {
      std::vector<std::uint64_t> words(size, small);
      std::set<std::uint64_t> hashes;
      const auto keep = [&] {
        Hash64 hash;
        hash.add(std::as_bytes(std::span(words)));
        hashes.insert(hash.value());
      };
      keep();
      for (std::uint64_t& word : words) {
        for (const std::uint64_t other : {small + 1, small + 2, ~small}) {
          word = other;
          keep();
        }
        word = small;
      }
      ASSERT_EQ(hashes.size(), 1 + 3 * size) << size << " words of " << small;
    }
  }
}

TEST(Hash64, is_another_one_with_another_seed) {
  const auto hash_of = [](std::uint64_t seed) {
    Hash64 hash(seed);
    hash.add(std::string_view("profile"));
    return hash.value();
  };
  EXPECT_EQ(hash_of(1), hash_of(1));
  EXPECT_NE(hash_of(1), hash_of(2));
  EXPECT_NE(hash_of(0), hash_of(1));
}

TEST(Hash64, does_not_depend_on_how_the_octets_are_cut) {
  std::vector<std::byte> octets;
  for (int i = 0; i < 100; ++i) octets.push_back(static_cast<std::byte>(i * 7));
  Hash64 whole;
  whole.add(std::span<const std::byte>(octets));
  EXPECT_EQ(whole.value(), 0x2ab40818ced6dc86U) << "logs that exist have other hashes now";
  for (std::size_t cut = 0; cut <= octets.size(); ++cut) {
    Hash64 pieces;
    pieces.add(std::span<const std::byte>(octets).first(cut));
    pieces.add(std::span<const std::byte>(octets).subspan(cut));
    EXPECT_EQ(pieces.value(), whole.value()) << cut;
  }
  octets[99] ^= std::byte{1};
  Hash64 other;
  other.add(std::span<const std::byte>(octets));
  EXPECT_NE(other.value(), whole.value());
}

}  // namespace
}  // namespace base

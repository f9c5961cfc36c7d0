#include "sim_tick.h"

#include <gtest/gtest.h>
#include <unistd.h>
#include <filesystem>
#include <map>
#include <set>

namespace {

using base::HashKey;

// What one tick left in the log, by "out A:port" and "in A:port".
struct Entry {
  std::uint64_t hash = 0;
  std::string value;
};
using Entries = std::map<std::string, Entry>;

class SimTicks : public testing::Test {
 protected:
  SimTicks() {
    std::filesystem::create_directory(folder_);
    tick_.emplace();
    EXPECT_EQ(tick_->keep_hashes(folder_, "A", 1), "");
  }
  ~SimTicks() override { std::filesystem::remove_all(folder_); }

  std::optional<std::uint64_t> pass(const std::string& port, bool is_out, std::initializer_list<std::string> pieces) {
    std::vector<std::span<const std::byte>> octets;
    for (const auto& piece : pieces) octets.push_back(std::as_bytes(std::span(piece)));
    std::optional<std::uint64_t> hash;
    tick_->passed({is_out, port, "type", octets, &hash});
    return hash;
  }
  void begin() { tick_->begin({.now = std::chrono::milliseconds(++ticks_)}); }
  void end() {
    tick_->end([] { return 7U; });
  }
  std::vector<Entries> written() {
    tick_.reset();
    auto log = base::HashLogReader::open(std::filesystem::directory_iterator(folder_)->path());
    EXPECT_TRUE(log.ok());
    std::vector<Entries> all;
    base::HashTick tick;
    while (*log->next(tick)) {
      Entries& entries = all.emplace_back();
      for (const auto& entry : tick.entries) {
        const HashKey& key = log->keys()[entry.key];
        if (key.kind == HashKey::Kind::component) continue;
        EXPECT_TRUE(entries.try_emplace((key.kind == HashKey::Kind::out_port ? "out " : "in ") + key.name, entry.hash, entry.value).second);
      }
    }
    return all;
  }

  std::optional<SimTick> tick_;

 private:
  const std::string folder_ = testing::TempDir() + "sim_ticks-" + std::to_string(getpid());
  int ticks_ = 0;
};

TEST_F(SimTicks, each_port_has_its_own_entry_whatever_the_order) {
  for (const bool is_turned : {false, true, false}) {
    begin();
    for (const int i : is_turned ? std::array{2, 1, 0} : std::array{0, 1, 2})
      pass(std::array{"A.a", "A.b", "A.a"}[i], i == 2, {std::to_string(i)});
    end();
  }
  begin();
  pass("A.new", true, {"3"});
  pass("A.a", false, {"0"});
  end();
  const auto ticks = written();
  ASSERT_EQ(ticks.size(), 4U);
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(ticks[i].size(), 3U) << i;
    EXPECT_EQ(ticks[i].at("in A:a").value, "0");
    EXPECT_EQ(ticks[i].at("in A:b").value, "1");
    EXPECT_EQ(ticks[i].at("out A:a").value, "2");
    EXPECT_EQ(ticks[i].at("out A:a").hash, ticks[0].at("out A:a").hash);
  }
  ASSERT_EQ(ticks[3].size(), 2U);
  EXPECT_EQ(ticks[3].at("out A:new").value, "3");
  EXPECT_EQ(ticks[3].at("in A:a").hash, ticks[0].at("in A:a").hash);
}

TEST_F(SimTicks, a_sample_has_one_hash_at_both_ends_however_it_is_cut) {
  const std::string longest(base::longest_hash_value, 'x'), longer(base::longest_hash_value + 1, 'x');
  begin();
  EXPECT_FALSE(pass("A.a", true, {longest}));
  const auto hash = pass("A.b", true, {longer});
  ASSERT_TRUE(hash);
  pass("A.a", false, {longest.substr(0, 9), "", longest.substr(9)});
  EXPECT_TRUE(tick_->passed_again({false, "A.b", "type", {}}, *hash));
  end();
  const auto ticks = written();
  ASSERT_EQ(ticks.size(), 1U);
  EXPECT_EQ(ticks[0].at("out A:a").hash, ticks[0].at("in A:a").hash);
  EXPECT_EQ(ticks[0].at("out A:b").hash, ticks[0].at("in A:b").hash);
  EXPECT_EQ(ticks[0].at("in A:a").value, longest);
  EXPECT_EQ(ticks[0].at("in A:b").value, "");
}

TEST_F(SimTicks, of_several_samples_all_count_and_the_last_one_is_kept) {
  const std::string longer(base::longest_hash_value + 1, 'x');
  const auto samples = [&](std::initializer_list<std::string> all) {
    begin();
    for (const auto& one : all) pass("A.a", true, {one});
    end();
  };
  samples({"1", "2"});
  samples({"2", "1"});
  samples({"1"});
  samples({longer, "1"});
  samples({"1", longer});
  const auto ticks = written();
  ASSERT_EQ(ticks.size(), 5U);
  std::set<std::uint64_t> hashes;
  std::vector<std::string> values;
  for (const auto& tick : ticks) {
    hashes.insert(tick.at("out A:a").hash);
    values.push_back(tick.at("out A:a").value);
  }
  EXPECT_EQ(hashes.size(), 5U);
  EXPECT_EQ(values, (std::vector<std::string>{"2", "1", "1", "1", ""}));
}

}  // namespace

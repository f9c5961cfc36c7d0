#include "core/fault.h"

#include <gtest/gtest.h>

#include <memory>

namespace rt {
namespace {

using namespace std::chrono_literals;

std::vector<Fault> faults(const std::string& text) {
  auto parsed = parse_faults(text);
  return parsed ? *parsed : std::vector<Fault>{};
}

// The numbers 0 to count-1 go in, one each tenth of a second; what comes out.
std::vector<int> sent(const std::string& text, int count) {
  FaultyLink link(faults(text));
  std::vector<int> out;
  for (int i = 0; i < count; ++i) {
    Sample sample;
    sample.value = std::make_shared<int>(i);
    for (const auto& passed : link.pass(std::move(sample), i * 100ms)) out.push_back(*static_cast<const int*>(passed.value.get()));
  }
  return out;
}

TEST(Faults, are_read_from_a_text) {
  const auto two = faults("drop:2:1:0.5:7 hang:3:0:0:1");
  ASSERT_EQ(two.size(), 2U);
  EXPECT_EQ(two[0].kind, Fault::Kind::drop);
  EXPECT_FALSE(two[0].is_at(1999ms));
  EXPECT_TRUE(two[0].is_at(2s));
  EXPECT_FALSE(two[0].is_at(3s));
  EXPECT_TRUE(two[1].is_at(1000h));
  for (const char* text : {"drop", "drop:1:1:1", "fall:1:1:1:1", "drop:-1:1:1:1", "drop:1:1:x:1", "delay:1:1:1001:1"})
    EXPECT_FALSE(parse_faults(text)) << text;
}

TEST(FaultyLinks, drop_while_the_fault_lasts) { EXPECT_EQ(sent("drop:0.2:0.3:1:1", 7), (std::vector<int>{0, 1, 5, 6})); }

TEST(FaultyLinks, delay_by_samples_and_send_the_rest_afterwards) {
  EXPECT_EQ(sent("delay:0.1:0.4:2:1", 7), (std::vector<int>{0, 1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(sent("delay:0:0:2:1", 5), (std::vector<int>{0, 1, 2}));
}

TEST(FaultyLinks, send_twice) { EXPECT_EQ(sent("duplicate:0.1:0.2:1:1", 4), (std::vector<int>{0, 1, 1, 2, 2, 3})); }

TEST(FaultyLinks, exchange_neighbours) { EXPECT_EQ(sent("reorder:0:0.5:1:1", 6), (std::vector<int>{1, 0, 3, 2, 5, 4})); }

TEST(FaultyLinks, choose_by_their_seed) {
  EXPECT_EQ(sent("drop:0:0:0.5:1", 100), sent("drop:0:0:0.5:1", 100));
  EXPECT_NE(sent("drop:0:0:0.5:1", 100), sent("drop:0:0:0.5:2", 100));
  EXPECT_NEAR(static_cast<double>(sent("drop:0:0:0.3:5", 10000).size()), 7000, 150);
}

}  // namespace
}  // namespace rt

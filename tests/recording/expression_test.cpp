// Conditions of rtse goto --break, and differences of samples.
#include "recording/expression.h"

#include <gtest/gtest.h>

#include <map>

#include "recording/sample_difference.h"

namespace recorder {
namespace {

bool holds(const std::string& text, const std::map<std::string, double>& known = {}) {
  const auto expression = Expression::parse(text);
  EXPECT_TRUE(expression) << expression.error().message;
  return expression && expression->holds([&](const Expression::Value& value) -> std::optional<double> {
    const auto found = known.find(value.name + (value.member.empty() ? "" : "." + value.member));
    return found == known.end() ? std::nullopt : std::optional(found->second);
  });
}

TEST(Expression, compares_numbers_both_ways) {
  EXPECT_TRUE(holds("1 < 2 && 2 > 1 && 2 <= 2 && 2 >= 2 && 1 == 1 && 1 != 2 && -1.5e1 < 0"));
  EXPECT_FALSE(holds("2 < 1"));
  EXPECT_FALSE(holds("1 != 1"));
}

TEST(Expression, and_binds_more_than_or) {
  EXPECT_TRUE(holds("1 == 1 || 1 == 2 && 1 == 2"));
  EXPECT_FALSE(holds("(1 == 1 || 1 == 2) && 1 == 2"));
  EXPECT_TRUE(holds("!(1 == 2) && !!(1 == 1)"));
}

TEST(Expression, a_value_that_is_not_there_makes_its_comparison_false) {
  EXPECT_FALSE(holds("A0:out.data < 5"));
  EXPECT_TRUE(holds("A0:out.data < 5 || 1 == 1"));
  EXPECT_TRUE(holds("A0:out.data[2].x < 5", {{"A0:out.data[2].x", 4}}));
  EXPECT_TRUE(holds("pose(a::b).yaw > 1 && state(A0) == Error", {{"a::b.yaw", 2}, {"A0", 3}}));
}

TEST(Expression, says_what_it_needs) {
  const auto expression = Expression::parse("time > 3 && (pose(m).x < 1 || pose(m).x > 2) && A0:o.d != 0");
  ASSERT_TRUE(expression) << expression.error().message;
  std::vector<std::string> needed;
  for (const auto& value : expression->values()) needed.push_back(value.name + "." + value.member);
  EXPECT_EQ(needed, (std::vector<std::string>{".", "m.x", "A0:o.d"}));
}

TEST(Expression, what_is_wrong_is_named_with_its_place) {
  for (const auto& [text, says] : std::map<std::string, std::string>{{"1 <", "at octet 4: expected a value"},
                                                                     {"1 2", "expected <, <="},
                                                                     {"(1 < 2", "expected )"},
                                                                     {"1 < 2 3", "expected && or || or the end"},
                                                                     {"speed < 2", "expected a number, time"},
                                                                     {"pose(m).roll < 2", "expected .x, .y, .z or .yaw"},
                                                                     {"", "expected a value"}}) {
    const auto expression = Expression::parse(text);
    ASSERT_FALSE(expression) << text;
    EXPECT_NE(expression.error().message.find(says), std::string::npos) << text << ": " << expression.error().message;
  }
  EXPECT_FALSE(Expression::parse(std::string(100000, '(')));
  EXPECT_FALSE(Expression::parse(std::string(100000, '!').append("1 < 2")));
}

TEST(SampleDifference, names_the_first_member_and_both_values) {
  const Json a = {{"tm", {{"sec", 1}}}, {"data", {{"v", {1.0, 2.0}}}}};
  const Json b = {{"tm", {{"sec", 2}}}, {"data", {{"v", {1.0, 2.5}}}}};
  EXPECT_EQ(difference({}, a, b), "tm.sec: 1 and 2");
  EXPECT_EQ(difference({.ignored = {"tm"}, .tolerances = {}}, a, b), "data.v[1]: 2.0 and 2.5");
  EXPECT_EQ(difference({.ignored = {"tm"}, .tolerances = {{"data.v", 0.4}}}, a, b), "data.v[1]: 2.0 and 2.5");
  EXPECT_EQ(difference({.ignored = {"tm"}, .tolerances = {{"data.v", 0.5}}}, a, b), std::nullopt);
  EXPECT_EQ(difference({.ignored = {}, .tolerances = {{"", 1}}}, a, b), std::nullopt);
}

TEST(SampleDifference, a_tolerance_is_a_member_and_a_number) {
  EXPECT_EQ(parse_tolerance("data.vx=1e-3")->first, "data.vx");
  EXPECT_EQ(parse_tolerance("0.5")->second, 0.5);
  for (const char* wrong : {"", "=1", "a=", "a=x", "a=-1", "a=nan"}) EXPECT_FALSE(parse_tolerance(wrong)) << wrong;
}

}  // namespace
}  // namespace recorder

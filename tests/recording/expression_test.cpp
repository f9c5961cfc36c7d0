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
  return expression && expression
                           ->holds([&](const Expression::Value& value) -> std::optional<double> {
                             const auto found = known.find(value.name + (value.member.empty() ? "" : "." + value.member));
                             return found == known.end() ? std::nullopt : std::optional(found->second);
                           })
                           .value();
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

TEST(Expression, numbers_have_units) {
  EXPECT_TRUE(holds("pose(m).x == 2.5 m && pose(m).x == 250cm && pose(m).x <= 2500 mm", {{"m.x", 2.5}}));
  EXPECT_TRUE(holds("pose(m).yaw > 89 deg && pose(m).yaw < 91deg && pose(m).yaw < 2 rad", {{"m.yaw", 1.5708}}));
  EXPECT_TRUE(holds("A0:out.data < 2 m && A0:out.data < 2 s && A0:out.data < 2", {{"A0:out.data", 1}}));
  EXPECT_TRUE(holds("state(A0) == Created && state(A0) < 1", {{"A0", 0}}));
  EXPECT_TRUE(holds("1 min == 60 s && 1 s == 1000ms"));
}

TEST(Expression, contacts_are_conditions_by_themselves) {
  EXPECT_TRUE(holds("touches(robot, wall)", {{"robot.wall", 1}}));
  EXPECT_FALSE(holds("touches(robot, wall)", {{"robot.wall", 0}}));
  EXPECT_TRUE(holds("!touches(robot, wall) && 1 == 1", {{"robot.wall", 0}}));
}

double shortfall(const std::string& text, double x, double y) {
  return Expression::parse(text)
      ->shortfall([&](const auto& value) -> std::optional<double> { return value.member == "x" ? x : y; })
      .value();
}

TEST(Expression, the_shortfall_is_the_distance_to_where_it_holds) {
  const std::string region = "pose(m).x >= 1 && pose(m).y >= 1 && pose(m).x <= 2 && pose(m).y <= 2";
  EXPECT_EQ(shortfall(region, 1.5, 2), 0);
  EXPECT_EQ(shortfall(region, 5, 6), 5);
  EXPECT_EQ(shortfall("pose(m).x > 2 || pose(m).x < 1", 1.25, 0), 0.25);
  EXPECT_GT(shortfall("pose(m).x < 1", 1, 0), 0);
}

TEST(Expression, a_comparison_that_decides_ends_the_evaluation) {
  std::vector<std::string> asked;
  const auto look_up = [&](const Expression::Value& value) -> std::optional<double> {
    asked.push_back(value.name);
    return 0;
  };
  EXPECT_FALSE(Expression::parse("time > 3 && state(A0) == Error")->holds(look_up).value());
  EXPECT_EQ(asked, (std::vector<std::string>{""}));
}

TEST(Expression, an_error_of_a_value_ends_the_evaluation) {
  const auto failed = Expression::parse("time > 3 || time < 3")->holds([](const auto&) { return base::Error{"gone"}; });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "gone");
}

TEST(Expression, says_what_it_needs) {
  const auto expression = Expression::parse("time > 3 && (pose(m).x < 1 || pose(m).x > 2) && A0:o.d != 0");
  ASSERT_TRUE(expression) << expression.error().message;
  std::vector<std::string> needed;
  for (const auto& value : expression->values()) needed.push_back(value.name + "." + value.member);
  EXPECT_EQ(needed, (std::vector<std::string>{".", "m.x", "A0:o.d"}));
}

TEST(Expression, what_is_wrong_is_named_with_its_place) {
  for (const auto& [text, says] : std::map<std::string, std::string>{{"1 <", "condition \"1 <\":4: expected a value, got the end"},
                                                                     {"1 2", "expected <, <="},
                                                                     {"(1 < 2", ":7: expected ), got the end"},
                                                                     {"1 < 2 3", ":7: expected && or || or the end, got \"3\""},
                                                                     {"speed < 2", "expected a number, time"},
                                                                     {"pose(m).roll < 2", ":8: expected .x, .y, .z or .yaw, got \".roll\""},
                                                                     {"pose(m).x < 2 s", ":13: expected a value in m, not in s, got \"2\""},
                                                                     {"time < pose(m).x", "expected a value in s, not in m"},
                                                                     {"state(A0) == 1 m", "expected a value in states, not in m"},
                                                                     {"touches(m) ", "expected a comma and another model"},
                                                                     {"1 < 2 km", "expected && or || or the end, got \"km\""},
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

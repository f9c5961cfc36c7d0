#include "system/parameter_check.h"

#include <gtest/gtest.h>

namespace tools {
namespace {

bool is_type(const char* type, const char* value) { return type_problem(type, value).empty(); }
bool is_allowed(const char* constraint, const char* value) { return constraint_problem(constraint, value).empty(); }

TEST(ParameterCheckTest, numbers_are_of_their_type) {
  for (const char* good : {"0", "-5", " 42 ", "2147483647", "+1"}) EXPECT_TRUE(is_type("int", good)) << good;
  for (const char* bad : {"", "abc", "1.5", "1e9", "99999999999", "1.5?", "0x10", "nan"}) EXPECT_FALSE(is_type("int", bad)) << bad;
  EXPECT_FALSE(is_type("unsigned int", "-1"));
  EXPECT_FALSE(is_type("short", "40000"));
  EXPECT_TRUE(is_type("unsigned short", "40000"));
  EXPECT_TRUE(is_type("long", "99999999999"));
  EXPECT_TRUE(is_type("double", "-1e308"));
  EXPECT_FALSE(is_type("float", "1e308"));
  for (const char* bad : {"", "one", "nan", "inf", "1,5"}) EXPECT_FALSE(is_type("double", bad)) << bad;
  EXPECT_TRUE(is_type("bool", "YES"));
  EXPECT_FALSE(is_type("bool", "2"));
}

TEST(ParameterCheckTest, lists_are_of_their_members_type) {
  EXPECT_TRUE(is_type("std::vector<double>", "1, 2.5,3"));
  EXPECT_TRUE(is_type("std::vector<int>", ""));
  EXPECT_FALSE(is_type("std::vector<int>", "1,x"));
}

TEST(ParameterCheckTest, what_is_not_known_is_allowed) {
  EXPECT_TRUE(is_type("", "anything"));
  EXPECT_TRUE(is_type("string", ""));
  EXPECT_TRUE(is_type("MyEnum", "3"));
  EXPECT_TRUE(is_allowed("", "anything"));
  EXPECT_TRUE(is_allowed("x is nice", "anything"));
  EXPECT_TRUE(is_allowed("{key:(a,b)}", "anything"));
}

TEST(ParameterCheckTest, numbers_keep_within_their_limits) {
  EXPECT_TRUE(is_allowed("0<=x<=9999", "9999"));
  EXPECT_FALSE(is_allowed("0<=x<=9999", "10000"));
  EXPECT_FALSE(is_allowed("0 < x < 1", "0"));
  EXPECT_TRUE(is_allowed("0 < x < 1", "0.5"));
  EXPECT_FALSE(is_allowed("x>=0", "-1"));
  EXPECT_TRUE(is_allowed("0<=x", "0"));
  EXPECT_FALSE(is_allowed("10>x", "10"));
  EXPECT_FALSE(is_allowed("x>=0", "abc"));
  EXPECT_TRUE(is_allowed("x!=3", "4"));
  EXPECT_FALSE(is_allowed("x!=3", "3"));
  EXPECT_FALSE(is_allowed("x=3", "4"));
}

TEST(ParameterCheckTest, limits_of_lists_go_by_place) {
  EXPECT_TRUE(is_allowed("x<1,y<2", "0,1"));
  EXPECT_EQ(constraint_problem("x<1,y<2", "0,3"), "y<2 in place 2");
}

TEST(ParameterCheckTest, choices_are_chosen_from) {
  EXPECT_TRUE(is_allowed("(slow,fast)", "fast"));
  EXPECT_EQ(constraint_problem("(slow, fast)", "faster"), "one of slow, fast");
  EXPECT_TRUE(is_allowed("{a,b,c}", "a,c"));
  EXPECT_FALSE(is_allowed("{a,b,c}", "a,d"));
}

}  // namespace
}  // namespace tools

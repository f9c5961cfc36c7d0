// The string functions of coil in their 1.x and 2.x spellings.
#include <coil/stringutil.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

namespace {

TEST(StringUtil, lines_end_as_on_every_system) {
  std::istringstream in("one\r\ntwo\n\nlast");
  std::string line;
  std::string all;
  std::vector<int> lengths;
  while (in.good()) {
    lengths.push_back(coil::getlinePortable(in, line));
    all += line + "|";
  }
  EXPECT_EQ(all, "one|two||last|");
  EXPECT_EQ(lengths, (std::vector<int>{3, 3, 0, 4}));
}

TEST(StringUtil, a_1x_call_changes_the_variable) {
  std::string s = "  A b ";
  coil::normalize(s);
  EXPECT_EQ(s, "a b");
  coil::eraseBlank(s);
  EXPECT_EQ(s, "ab");
  coil::replaceString(s, "b", "xyz");
  EXPECT_EQ(s, "axyz");
  coil::toUpper(s);
  EXPECT_EQ(s, "AXYZ");
  s = "  x  ";
  coil::eraseHeadBlank(s);
  EXPECT_EQ(s, "x  ");
  coil::eraseTailBlank(s);
  EXPECT_EQ(s, "x");
}

TEST(StringUtil, a_2x_call_returns_the_result_and_leaves_the_variable) {
  std::string s = " Yes ";
  std::string t = coil::normalize(s);
  EXPECT_EQ(t, "yes");
  EXPECT_EQ(s, " Yes ");
  EXPECT_TRUE(coil::normalize(s) == "yes");
  EXPECT_EQ(s, " Yes ");
  auto u = coil::toLower(s);
  EXPECT_STREQ(u.c_str(), " yes ");
  EXPECT_EQ("<" + coil::eraseBlank(s) + ">", "<Yes>");
  EXPECT_EQ(s, " Yes ");
  s = coil::eraseBothEndsBlank(std::move(s));
  EXPECT_EQ(s, "Yes");
  s = coil::toUpper(s);
  EXPECT_EQ(s, "YES");
  const std::string c = "a-b";
  EXPECT_EQ(coil::replaceString(c, "-", "--"), "a--b");
  EXPECT_EQ(coil::toLower("LITERAL"), "literal");
}

TEST(StringUtil, split_trims_parts_and_can_leave_out_empty_ones) {
  EXPECT_EQ(coil::split("a, b ,,c", ","), (coil::vstring{"a", "b", "", "c"}));
  EXPECT_EQ(coil::split("a, b ,,c", ",", true), (coil::vstring{"a", "b", "c"}));
  EXPECT_EQ(coil::split("", ","), coil::vstring{});
  EXPECT_EQ(coil::split("a::b", "::"), (coil::vstring{"a", "b"}));
  EXPECT_EQ(coil::flatten({"a", "b"}), "a, b");
  EXPECT_EQ(coil::flatten({"a", "b"}, "/"), "a/b");
  EXPECT_EQ(coil::unique_sv({"b", "a", "b"}), (coil::vstring{"a", "b"}));
}

TEST(StringUtil, string_to_leaves_the_value_alone_when_the_text_does_not_fit) {
  int i = 7;
  EXPECT_FALSE(coil::stringTo(i, "x"));
  EXPECT_EQ(i, 7);
  EXPECT_TRUE(coil::stringTo(i, "42"));
  EXPECT_EQ(i, 42);
  double d = 0;
  EXPECT_TRUE(coil::stringTo<double>(d, "2.5e3"));
  EXPECT_EQ(d, 2500);
  std::string s;
  EXPECT_TRUE(coil::stringTo(s, "with blanks"));
  EXPECT_EQ(s, "with blanks");
  bool b = false;
  EXPECT_TRUE(coil::stringTo(b, "True"));
  EXPECT_TRUE(b);
  EXPECT_TRUE(coil::stringTo(b, "0"));
  EXPECT_FALSE(b);
  EXPECT_FALSE(coil::stringTo(b, "perhaps"));
  EXPECT_FALSE(coil::stringTo(i, nullptr));
}

TEST(StringUtil, string_to_reads_durations_and_vectors) {
  std::chrono::nanoseconds t{};
  EXPECT_TRUE(coil::stringTo(t, "0.5"));
  EXPECT_EQ(t, std::chrono::milliseconds(500));
  EXPECT_FALSE(coil::stringTo(t, "1e300"));
  std::vector<double> v{9};
  EXPECT_TRUE(coil::stringTo(v, "1.0, 2.5,3"));
  EXPECT_EQ(v, (std::vector<double>{1, 2.5, 3}));
  EXPECT_FALSE(coil::stringTo(v, "1,x"));
  EXPECT_EQ(v.size(), 3u);
}

TEST(StringUtil, questions) {
  EXPECT_TRUE(coil::toBool("yes", "YES", "NO", false));
  EXPECT_FALSE(coil::toBool("No", "YES", "NO", true));
  EXPECT_TRUE(coil::toBool("", "YES", "NO", true));
  EXPECT_TRUE(coil::includes("a, B", "b"));
  EXPECT_FALSE(coil::includes("a, B", "b", false));
  EXPECT_TRUE(coil::isAbsolutePath("/x"));
  EXPECT_TRUE(coil::isURL("http://x"));
  EXPECT_FALSE(coil::isURL("://x"));
  EXPECT_TRUE(coil::isIPv4("127.0.0.1"));
  EXPECT_FALSE(coil::isIPv4("127.0.0.256"));
  EXPECT_FALSE(coil::isIPv4("127.0.1"));
  EXPECT_TRUE(coil::isIPv6("::1"));
  EXPECT_TRUE(coil::isIPv6("fe80::1%eth0"));
  EXPECT_FALSE(coil::isIPv6("12:34"));
  EXPECT_TRUE(coil::isIPPort("2809"));
  EXPECT_FALSE(coil::isIPPort("65536"));
}

TEST(StringUtil, escapes_and_their_reverse) {
  EXPECT_EQ(coil::escape("a\tb\n\"\\"), "a\\tb\\n\\\"\\\\");
  EXPECT_EQ(coil::unescape(coil::escape("a\tb\n\"\\'")), "a\tb\n\"\\'");
  EXPECT_TRUE(coil::isEscaped("a\\b", 2));
  EXPECT_FALSE(coil::isEscaped("a\\\\b", 3));
}

TEST(StringUtil, the_rest) {
  EXPECT_EQ(coil::sprintf("%s %d", "x", 5), "x 5");
  EXPECT_EQ(coil::otos(2.5), "2.5");
  EXPECT_EQ(coil::otos("abc"), "abc");
  EXPECT_EQ(coil::urlparam2map("host?a=1&b=&c"), (coil::mapstring{{"a", "1"}, {"b", ""}, {"c", ""}}));
  setenv("COIL_TEST_VARIABLE", "value", 1);
  EXPECT_EQ(coil::replaceEnv("x${COIL_TEST_VARIABLE}y${COIL_TEST_UNSET}"), "xvaluey");
  coil::Argv argv({"a", "b"});
  EXPECT_STREQ(argv.argv()[1], "b");
  EXPECT_EQ(argv.argv()[2], nullptr);
  std::istringstream in("one\r\ntwo");
  std::string line;
  EXPECT_EQ(coil::getline(in, line), 3);
  EXPECT_EQ(coil::getline(in, line), 3);
  EXPECT_EQ(coil::getline(in, line), -1);
}

}  // namespace

#include "base/text.h"

#include <gtest/gtest.h>

#include "base/id.h"

namespace base {
namespace {

TEST(Text, lists_are_split_at_separators_and_trimmed) {
  EXPECT_EQ(split_list(" a, b ,,c "), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_TRUE(split_list("  ").empty());
}

TEST(Text, a_time_is_seconds_or_has_a_unit) {
  EXPECT_EQ(parse_seconds("30"), 30.0);
  EXPECT_EQ(parse_seconds(" 30s "), 30.0);
  EXPECT_EQ(parse_seconds("500ms"), 0.5);
  EXPECT_EQ(parse_seconds("2min"), 120.0);
  EXPECT_EQ(parse_seconds("1.5m"), 90.0);
  EXPECT_EQ(parse_seconds("1h"), 3600.0);
  EXPECT_DOUBLE_EQ(parse_seconds("250us").value_or(0), 2.5e-4);
  for (const auto bad : {"", "s", "1d", "1 2s", "nans", "1e308h", "ms"}) EXPECT_EQ(parse_seconds(bad), std::nullopt) << bad;
}

TEST(Text, numbers_are_read_whole_or_not_at_all) {
  EXPECT_EQ(parse_number(" -1.5e3 "), -1500.0);
  EXPECT_EQ(parse_number("+2"), 2.0);
  for (const auto bad : {"", "1x", "nan", "inf", "1e999", "+-1", "1 2"}) EXPECT_EQ(parse_number(bad), std::nullopt) << bad;
}

TEST(Text, integers_do_not_overflow) {
  EXPECT_EQ(parse_integer("-9223372036854775808"), INT64_MIN);
  EXPECT_EQ(parse_integer("9223372036854775808"), std::nullopt);
  EXPECT_EQ(parse_integer("1.0"), std::nullopt);
}

TEST(Text, formatted_numbers_read_back_the_same) {
  for (const double value : {0.1, -1.0 / 3.0, 1e300, 5.0}) EXPECT_EQ(parse_number(format_number(value)), value);
}

TEST(Text, foreign_text_fits_one_line) {
  EXPECT_EQ(in_quotes("a\nb"), "\"a\\x0ab\"");
  EXPECT_EQ(printable("\x1b[2Jä\xc2\x9b\x7f\n", "\n"), "\\x1b[2Jä\\xc2\\x9b\\x7f\n");
  EXPECT_EQ(in_quotes(std::string(1000, 'x')).size(), 125u);
}

TEST(Text, what_a_terminal_obeys_or_cannot_read_is_not_given_to_it) {
  EXPECT_EQ(printable("a\x9b"
                      "31m\xff"),
            "a\xef\xbf\xbd"
            "31m\xef\xbf\xbd");
  for (const auto turn : {"\xd8\x9c", "\xe2\x80\x8e", "\xe2\x80\x8f", "\xe2\x81\xa6", "\xe2\x80\xa8"})
    EXPECT_EQ(printable(turn).find(turn), std::string::npos) << printable(turn);
  EXPECT_EQ(printable("\xe2\x80\xae"
                      "gpj\xe2\x81\xa6"),
            "\\xe2\\x80\\xaegpj\\xe2\\x81\\xa6")
      << "U+202E, U+2066";
  EXPECT_EQ(printable("\xc2\x85\xc0\x80\xed\xa0\x80"), "\\xc2\\x85\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd\xef\xbf\xbd");
  EXPECT_EQ(printable("\xe6\x97\xa5\xf0\x9f\xa4\x96"), "\xe6\x97\xa5\xf0\x9f\xa4\x96");
  EXPECT_EQ(in_quotes(std::string(119, 'x') + "\xc3\xa4" + "yy"), '"' + std::string(119, 'x') + "\"...") << "not cut within a character";
}

TEST(Id, uuids_differ_and_have_the_usual_form) {
  const auto a = make_uuid();
  EXPECT_EQ(a.size(), 36u);
  EXPECT_EQ(a[14], '4');
  EXPECT_NE(a, make_uuid());
}

}  // namespace
}  // namespace base

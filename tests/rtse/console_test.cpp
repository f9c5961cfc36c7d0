#include "rtse/console.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace tools {
namespace {

TEST(ConsoleTest, an_error_is_a_line_of_rtse_and_makes_the_command_fail) {
  Console console(false);
  EXPECT_FALSE(console.failed());
  testing::internal::CaptureStderr();
  console.fail({"component A0: is not there"});
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "rtse: component A0: is not there\n");
  EXPECT_TRUE(console.failed());
}

TEST(ConsoleTest, a_warning_does_not_make_the_command_fail) {
  Console console(false);
  testing::internal::CaptureStderr();
  console.warn("channel /hashes: is left out");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "rtse: channel /hashes: is left out\n");
  EXPECT_FALSE(console.failed());
}

TEST(ConsoleTest, control_characters_of_peers_are_printed_escaped) {
  Console console(false);
  testing::internal::CaptureStderr();
  console.fail({"component \x1b[2J: is not there"});
  console.warn("\x1b[2J");
  EXPECT_EQ(testing::internal::GetCapturedStderr().find('\x1b'), std::string::npos);
}

TEST(ConsoleTest, json_is_printed_also_with_text_that_is_not_utf8) {
  const Console console(true);
  testing::internal::CaptureStdout();
  console.print({{"name", "\xff"}});
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "{\n  \"name\": \"\xef\xbf\xbd\"\n}\n");
}

}  // namespace
}  // namespace tools

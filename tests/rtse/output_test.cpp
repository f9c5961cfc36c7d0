#include "rtse/output.h"

#include <gtest/gtest.h>

namespace editor {
namespace {

TEST(ForTerminal, commands_for_a_terminal_are_shown_and_not_obeyed) {
  EXPECT_EQ(for_terminal("evil\x1b[31m\r\x07\x7f"), "evil\\x1b[31m\\x0d\\x07\\x7f");
  EXPECT_EQ(for_terminal("\xc2\x9b"
                         "31m"),
            "\\x9b31m");
}

TEST(ForTerminal, lines_tabs_and_letters_of_all_alphabets_stay) {
  const std::string text = "a\tb\nGr\xc3\xbc\xc3\x9f\x65 \xe6\x97\xa5\xc2\xb0";
  EXPECT_EQ(for_terminal(text), text);
}

}  // namespace
}  // namespace editor

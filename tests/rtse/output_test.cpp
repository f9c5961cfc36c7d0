#include "rtse/output.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <sstream>

namespace tools {
namespace {

TEST(ForTerminal, commands_for_a_terminal_are_shown_and_not_obeyed) {
  EXPECT_EQ(for_terminal("evil\x1b[31m\r\x07\x7f"), "evil\\x1b[31m\\x0d\\x07\\x7f");
  EXPECT_EQ(for_terminal("\xc2\x9b"
                         "31m"),
            "\\xc2\\x9b31m");
  EXPECT_EQ(for_terminal("\x9b"
                         "31m"),
            "\\x9b31m");
}

TEST(ForTerminal, what_turns_the_direction_of_writing_is_shown) {
  EXPECT_EQ(for_terminal("\xe2\x80\xae"
                         "gpj.sh"),
            "\\xe2\\x80\\xaegpj.sh");
}

TEST(TerminalGuard, a_command_that_comes_in_pieces_is_not_obeyed_either) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  std::ostringstream stream;
  {
    const TerminalGuard guard(stream, terminal);
    for (const char c : std::string("\xc2\x9b"
                                    "31m \xe6\x97\xa5\xe2\x80\xae.\xe6"))
      stream << c;
  }
  EXPECT_EQ(stream.str(), "\\xc2\\x9b31m \xe6\x97\xa5\\xe2\\x80\\xae.\xe6");
  ::close(terminal);
}

TEST(ForTerminal, lines_tabs_and_letters_of_all_alphabets_stay) {
  const std::string text = "a\tb\nGr\xc3\xbc\xc3\x9f\x65 \xe6\x97\xa5\xc2\xb0";
  EXPECT_EQ(for_terminal(text), text);
}

}  // namespace
}  // namespace tools

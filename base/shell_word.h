// Text as words of a shell's command line, for commands that a user copies and pastes. Any thread.
//
// The words contain printable ASCII only, whatever the text contains: a control character in a pasted line would be obeyed by the terminal,
// a letter that is not ASCII may look like another one. bash, zsh and ksh read the text back, byte for byte. A NUL, which no word can hold,
// is left out.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace base {

// As it is, in single quotes when a shell would read it otherwise, as $'...' when it is not all printable ASCII.
std::string shell_word(std::string_view text);

// The words, separated by blanks.
std::string shell_line(const std::vector<std::string>& words);

// The words of a command whose operands come from elsewhere: "--" comes before the operands when one of them begins with '-' and is no
// number, so that no name is read as an option. Options come before operands.
std::vector<std::string> command_words(std::vector<std::string> options, const std::vector<std::string>& operands);

}  // namespace base

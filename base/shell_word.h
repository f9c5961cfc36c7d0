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

// The same for a script of /bin/sh, which is executed and not copied: all bytes unchanged, in single quotes where necessary.
std::string script_word(std::string_view text);

// The words, separated by blanks.
std::string shell_line(const std::vector<std::string>& words);

// The words of a command whose operands come from elsewhere, so that no name is read as an option: verb, operands, options. When an operand
// begins with '-' and is no number, the options come first and "--" before the operands.
std::vector<std::string> command_words(std::vector<std::string> verb, const std::vector<std::string>& operands,
                                       const std::vector<std::string>& options = {});

// An option and its value ("-n", "--name"): two words, or one when the value begins with '-'.
std::vector<std::string> option_words(const std::string& name, const std::string& value);

}  // namespace base

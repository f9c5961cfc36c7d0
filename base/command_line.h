// Standard options of all programs (--version, --completion, --man) and errors in one line. One thread at a time.
#pragma once

#include <optional>
#include <string>

#include "base/command.h"
#include "base/completion.h"

namespace base {

// Adds --version (prints "<name> <version>"), and --completion bash|zsh and --man, which print what their names say and end the program.
void add_standard_options(Command& app, const std::string& name, const std::string& version);

// Parses; the exit code when the program is to end now: 0 after --help and the like, 2 after a wrong command line (one line on stderr).
// After --complete it prints what may stand for the last word, see base/completion.h.
std::optional<int> parse_command_line(Command& app, const std::string& name, int argc, const char* const* argv, const Offers& offers = {});

// The manual page, from the same declarations as --help.
std::string manual_page(const Command& app, const std::string& name, const std::string& version);

}  // namespace base

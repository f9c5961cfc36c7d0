// Completion for shells: `PROGRAM --complete WORD...` prints the candidates for the last word, one per line.
// The scripts of --completion call it, so that names of the running system are offered, too. One thread at a
// time.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "base/command.h"

namespace base {

// What may stand there. A text that ends in ':', '=' or '/' is not the end of the word.
struct Offer {
  std::string text;
  std::string description = "";
};

// What a program itself knows. `value` is the name of a positional (PATH) or option (--manager), `before` are the words before it. Nothing:
// the fixed words of the declaration, else files.
using Offers = std::function<std::optional<std::vector<Offer>>(const std::string& value, const std::vector<std::string>& before,
                                                               const std::string& current)>;

struct Completion {
  std::vector<Offer> offers;
  bool files = false;  // the shell adds the names of files
};

// Words without the program's name; the last is the one at the cursor, as far as it is there.
Completion complete(const Command& app, const std::vector<std::string>& words, const Offers& offers = {});

// The subcommands that --help shows.
std::vector<const CLI::App*> commands_of(const CLI::App& app);

// The word that stands where a command is expected, of the program or of one of its commands, and is none; with those that there are.
struct UnknownCommand {
  std::string word;
  std::vector<std::string> known;
};
std::optional<UnknownCommand> unknown_command(const Command& app, const std::vector<std::string>& words);

// The script for bash or zsh.
std::string completion_script(const std::string& name, const std::string& shell);

}  // namespace base

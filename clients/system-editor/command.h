// How a command of rtse joins the program: it declares its part of the command line, and what is to be done when the user names it. Each
// file of commands/ has one or more; commands/commands.h lists them. One thread at a time.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "editor.h"

namespace editor {

// What the user has asked for; it is done when the whole command line has been read.
struct Chosen {
  std::function<void(Editor&)> work;
  bool needs_orb = true;  // without it the editor has no ORB, and asks no name server
};

// For what CLI11 cannot say of a command line: exit code 2 and a line.
inline void require(bool is_right, const std::string& command, const std::string& expectation) {
  if (!is_right) throw CLI::ValidationError(command, expectation);
}

}  // namespace editor

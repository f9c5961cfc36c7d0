// The interface of a command of rtse: it declares its command line, and the work to do if the user selects it. Each file of commands/ has
// one or more; commands/commands.h lists them. One thread at a time.
#pragma once

#include <functional>
#include <string>

#include "base/command.h"
#include "rtse/console.h"
#include "system/session.h"

namespace tools {

// What the user has asked for; it is done when the whole command line has been read.
struct Chosen {
  std::function<void(const Session&, Console&)> work;
  bool needs_orb = true;  // without it the session has no ORB, and the command calls no name server
};

// For what the declarations cannot say of a command line: exit code 2 and a line.
inline void require(bool is_right, const std::string& command, const std::string& expectation) {
  if (!is_right) base::reject_command_line(command, expectation);
}

}  // namespace tools

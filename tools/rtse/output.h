// Standard output of a command. Any thread.
#pragma once

#include "base/terminal.h"

namespace tools {

using base::for_terminal;
using base::TerminalGuard;

// Writes what is buffered; false when it could not be written and somebody would have wanted it.
bool flush_output();

}  // namespace tools

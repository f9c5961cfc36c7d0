// Text as one word of a shell's command line. Any thread.
#pragma once

#include <string>

namespace campaign {

inline std::string shell_word(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

}  // namespace campaign

// Standard output and standard error when they are terminals. Any thread, but for TerminalGuard: one for each stream, made before others
// write.
#pragma once

#include <memory>
#include <ostream>
#include <streambuf>
#include <string>
#include <string_view>

namespace base {

// Untrusted text, safe for a terminal: what a terminal would obey (is_obeyed, and single bytes of C1) is escaped as \x1b, except line ends
// and tabs.
std::string for_terminal(std::string_view text);

// While it lives, what goes through this stream to a terminal is fit for one: names and values come from peers, and one of them could be
// a command for the terminal. Into files and pipes octets go as they are, for programs.
class TerminalGuard {
 public:
  TerminalGuard(std::ostream& stream, int descriptor);
  ~TerminalGuard();
  TerminalGuard(const TerminalGuard&) = delete;
  TerminalGuard& operator=(const TerminalGuard&) = delete;

 private:
  std::ostream& stream_;
  std::streambuf* const target_;
  std::unique_ptr<std::streambuf> filter_;  // none: no terminal
};

}  // namespace base

// A process that ends inside a callback of a component, by a fatal signal or by exit(): one line on standard error names the component and
// the callback, so that the log of a process with many components shows which of them it was.
//
//   Relay0: the process ends in onExecute (signal 11)
//   Relay0: the process ends in onExecute (exit code 3)
//
// The signals are SIGSEGV, SIGBUS, SIGFPE, SIGILL and SIGABRT, where no other handler is installed. The process then ends by the same
// signal as it would have without the line, with the same core file. No line: SIGKILL, _exit(), an overflow of the stack, a thread of the
// author's.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace base {

// For its life, the calling thread runs this callback; several, one inside the other.
class CallbackOnStack {
 public:
  // `callback`: a literal. Names longer than 127 bytes are cut.
  CallbackOnStack(std::string_view component, const char* callback) noexcept;
  ~CallbackOnStack();
  CallbackOnStack(const CallbackOnStack&) = delete;
  CallbackOnStack& operator=(const CallbackOnStack&) = delete;

 private:
  friend class AbnormalExits;
  char component_[128];
  const char* const callback_;
  const CallbackOnStack* const outer_;
};

// From now on fatal signals leave a line. Any thread; a second call does nothing.
void report_fatal_signals();
// Writes the line if the calling thread is inside a callback; false: it is not. For a handler of exit().
bool report_exit_in_callback(int exit_code) noexcept;

struct AbnormalExit {
  std::string component, callback;
};
// Of a line of a log; nothing: the line is another one.
std::optional<AbnormalExit> parse_abnormal_exit(std::string_view line);

}  // namespace base

#include "base/abnormal_exit.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstring>

namespace base {
namespace {

constexpr std::string_view mark = ": the process ends in ";

}  // namespace

// What is written in a signal handler: no allocation, no lock, one write.
class AbnormalExits {
 public:
  static bool write_line(std::string_view how, int number) noexcept {
    const CallbackOnStack* running = innermost;
    if (running == nullptr) return false;
    char line[256];
    std::size_t size = 0;
    const auto add = [&](std::string_view text) {
      const auto count = std::min(text.size(), sizeof line - size);
      std::memcpy(line + size, text.data(), count);
      size += count;
    };
    char digits[16];
    const auto end = std::to_chars(digits, digits + sizeof digits, number).ptr;
    for (const std::string_view text : {std::string_view(running->component_), mark, std::string_view(running->callback_),
                                        std::string_view(" ("), how, std::string_view(digits, end), std::string_view(")\n")})
      add(text);
    return ::write(STDERR_FILENO, line, size) > 0;
  }

  static void on_signal(int number, siginfo_t* info, void*) noexcept {
    write_line("signal ", number);
    // What the processor has raised it raises again when the handler returns.
    if (info == nullptr || info->si_code <= 0) raise(number);
  }

  // Kept where a signal handler can read it without an allocation.
  __attribute__((tls_model("initial-exec"))) static thread_local const CallbackOnStack* innermost;
};
thread_local const CallbackOnStack* AbnormalExits::innermost = nullptr;

CallbackOnStack::CallbackOnStack(std::string_view component, const char* callback) noexcept
    : callback_(callback), outer_(AbnormalExits::innermost) {
  const auto size = std::min(component.size(), sizeof component_ - 1);
  std::memcpy(component_, component.data(), size);
  component_[size] = '\0';
  AbnormalExits::innermost = this;
}

CallbackOnStack::~CallbackOnStack() { AbnormalExits::innermost = outer_; }

void report_fatal_signals() {
  for (const int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    struct sigaction action {};
    if (sigaction(number, nullptr, &action) != 0 || (action.sa_flags & SA_SIGINFO) != 0 || action.sa_handler != SIG_DFL) continue;
    action = {};
    action.sa_sigaction = &AbnormalExits::on_signal;
    action.sa_flags = SA_SIGINFO | static_cast<int>(SA_RESETHAND) | SA_ONSTACK;
    sigaction(number, &action, nullptr);
  }
}

bool report_exit_in_callback(int exit_code) noexcept { return AbnormalExits::write_line("exit code ", exit_code); }

std::optional<AbnormalExit> parse_abnormal_exit(std::string_view line) {
  const auto at = line.find(mark);
  const auto end = line.rfind(" (");
  if (at == std::string_view::npos || end == std::string_view::npos || end < at + mark.size() || !line.ends_with(")")) return std::nullopt;
  return AbnormalExit{std::string(line.substr(0, at)), std::string(line.substr(at + mark.size(), end - at - mark.size()))};
}

}  // namespace base

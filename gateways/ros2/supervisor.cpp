#include "supervisor.h"

#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/log.h"

namespace ros2 {
namespace {

// So often at most, when it crashes at once.
constexpr timespec between_starts{0, 500'000'000};

sigset_t watched_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM, SIGCHLD}) sigaddset(&signals, signal);
  return signals;
}

// The status of the child when it has ended, as waitpid() has it.
int await_end(pid_t child, const sigset_t& signals, bool& is_told_to_end) {
  while (true) {
    const int signal = ::sigwaitinfo(&signals, nullptr);
    if (signal == SIGINT || signal == SIGTERM) {
      is_told_to_end = true;
      ::kill(child, SIGTERM);
    }
    int status = 0;
    if (::waitpid(child, &status, WNOHANG) == child) return status;
  }
}

}  // namespace

int supervise(const std::function<int()>& run) {
  const sigset_t signals = watched_signals();
  sigprocmask(SIG_BLOCK, &signals, nullptr);
  const pid_t parent = ::getpid();
  while (true) {
    const pid_t child = ::fork();
    if (child < 0) return run();  // better than nothing
    if (child == 0) {
      ::prctl(PR_SET_PDEATHSIG, SIGTERM);
      return ::getppid() == parent ? run() : 1;
    }
    bool is_told_to_end = false;
    const int status = await_end(child, signals, is_told_to_end);
    if (WIFEXITED(status)) return WEXITSTATUS(status);
    if (is_told_to_end) return 1;
    base::log(base::Level::error, "ros2-gateway", "ended by signal {} ({}); starting again", WTERMSIG(status),
              ::strsignal(WTERMSIG(status)));
    sigset_t ends;
    sigemptyset(&ends);
    sigaddset(&ends, SIGINT);
    sigaddset(&ends, SIGTERM);
    if (::sigtimedwait(&ends, nullptr, &between_starts) > 0) return 1;
  }
}

}  // namespace ros2

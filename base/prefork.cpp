#include "base/prefork.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/packet.h"

namespace base {
namespace {

constexpr int orders = STDIN_FILENO;
constexpr std::size_t longest_request = std::size_t{1} << 20U;

struct Order {
  std::vector<std::string> words, environment;
  int output = -1, watcher = -1;
};

bool has_one_thread() {
  std::error_code error;
  const std::filesystem::directory_iterator threads("/proc/self/task", error);
  return !error && std::distance(begin(threads), end(threads)) == 1;
}

// Nothing: nobody will ask any more.
std::optional<Order> next_order() {
  static std::vector<char> buffer(longest_request);
  auto packet = receive_packet(orders, std::as_writable_bytes(std::span(buffer)));
  if (!packet) return std::nullopt;
  Order order;
  if (packet->files.size() == 2) {
    order.output = packet->files[0].release();
    order.watcher = packet->files[1].release();
  }
  auto* list = &order.words;
  for (const char *at = buffer.data(), *end = at + packet->size; at < end; at += std::strlen(at) + 1) {
    if (*at == '\0' && list == &order.words) {
      list = &order.environment;
    } else {
      list->emplace_back(at);
    }
  }
  return order;
}

void tell(int watcher, int number) { static_cast<void>(!write(watcher, &number, sizeof number)); }

// The process as if it had been started with these words.
void become(const Order& order, const std::vector<int>& not_ours, pid_t parent, const sigset_t& mask) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (getppid() != parent) _exit(127);
  setpgid(0, 0);
  const int null = open("/dev/null", O_RDONLY | O_CLOEXEC);
  dup2(null, STDIN_FILENO);
  dup2(order.output, STDOUT_FILENO);
  dup2(order.output, STDERR_FILENO);
  for (const int descriptor : {null, order.output, order.watcher}) close(descriptor);
  for (const int descriptor : not_ours) close(descriptor);
  sigprocmask(SIG_SETMASK, &mask, nullptr);
  clearenv();
  for (const auto& variable : order.environment) {
    const auto sign = variable.find('=');
    setenv(variable.substr(0, sign).c_str(), sign == std::string::npos ? "" : variable.substr(sign + 1).c_str(), 1);
  }
}

// Those that run, by process; the pipe that waits for each one's end.
using Processes = std::map<pid_t, int>;

void take_ended(Processes& processes) {
  siginfo_t info{};
  while (waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid != 0) {
    const pid_t ended = std::exchange(info, {}).si_pid;
    kill(-ended, SIGKILL);  // what it has left behind, while its number cannot belong to anybody else
    int status = 0;
    waitpid(ended, &status, 0);
    const auto one = processes.extract(ended);
    if (one.empty()) continue;
    tell(one.mapped(), status);
    close(one.mapped());
  }
}

}  // namespace

bool is_prefork_server(int argc, char** argv) { return argc == 2 && std::string_view(argv[1]) == "--warm"; }

int make_processes(const std::function<int(int, char**)>& program) {
  if (!has_one_thread()) return 1;  // a fork would lose the others
  sigset_t ends, before;
  sigemptyset(&ends);
  sigaddset(&ends, SIGCHLD);
  sigprocmask(SIG_BLOCK, &ends, &before);
  const int signals = signalfd(-1, &ends, SFD_CLOEXEC | SFD_NONBLOCK);
  const pid_t own = getpid();
  Processes processes;
  for (;;) {
    std::array<pollfd, 2> events{{{orders, POLLIN, 0}, {signals, POLLIN, 0}}};
    if (poll(events.data(), events.size(), -1) < 0 && errno != EINTR) return 1;
    signalfd_siginfo ignored{};
    while (read(signals, &ignored, sizeof ignored) > 0) {
    }
    take_ended(processes);
    if (events[0].revents == 0) continue;
    const auto order = next_order();
    if (!order) return 0;
    if (order->words.empty() || order->watcher < 0) continue;
    std::vector<int> not_ours{signals};
    for (const auto& [pid, watcher] : processes) not_ours.push_back(watcher);
    const pid_t made = fork();
    if (made == 0) {
      become(*order, not_ours, own, before);
      std::vector<char*> words;
      for (const auto& word : order->words) words.push_back(const_cast<char*>(word.c_str()));
      words.push_back(nullptr);
      return program(static_cast<int>(order->words.size()), words.data());
    }
    close(order->output);
    if (made > 0) {
      setpgid(made, made);  // as it does itself: whoever comes first
      tell(order->watcher, made);
      processes.emplace(made, order->watcher);
    } else {
      close(order->watcher);
    }
  }
}

}  // namespace base

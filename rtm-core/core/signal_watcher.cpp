#include "core/signal_watcher.h"

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <future>
#include <map>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

namespace rt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds same_signal{50};  // as `timeout` sends two: to its child, and to the child's process group

volatile std::sig_atomic_t write_end = -1;  // what the handler needs; set before any handler is installed

void handle(int number) {
  const int saved = errno;
  const auto byte = static_cast<unsigned char>(number);
  [[maybe_unused]] const auto written = write(write_end, &byte, 1);
  errno = saved;
}

void set_handler(int number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(number, &action, nullptr);
}

}  // namespace

struct SignalWatcher::Impl {
  std::vector<int> signals;
  std::function<void(int)> call;
  int ends[2] = {-1, -1};
  std::thread thread;

  // Once there has been a signal of a number, until another one of it ends the process.
  std::map<int, Clock::time_point> until{};

  void give_back_due() {
    std::erase_if(until, [](const auto& one) {
      if (Clock::now() < one.second) return false;
      set_handler(one.first, SIG_DFL);
      return true;
    });
  }

  std::shared_future<void> latest;  // of the calls: over

  // A call may last as long as the end of a program. One after the other, on a thread: this one goes on to read. Nobody joins it, since the
  // process may end meanwhile.
  void begin_call(int number) {
    const auto before = latest;
    std::promise<void> done;
    auto over = done.get_future().share();
    try {
      std::thread([this, before, number, done = std::move(done)]() mutable {
        if (before.valid()) before.wait();
        call(number);
        done.set_value();
      }).detach();
      latest = std::move(over);
    } catch (const std::system_error&) {
      if (before.valid()) before.wait();
      call(number);
    }
  }

  void run() {
    pthread_setname_np(pthread_self(), "rtm-signals");
    std::set<int> seen;
    bool is_ending = false;
    while (!is_ending || !until.empty()) {
      pollfd news{is_ending ? -1 : ends[0], POLLIN, 0};
      const bool has_news = poll(&news, 1, until.empty() ? -1 : static_cast<int>(same_signal.count())) > 0;
      unsigned char number = 0;
      if (has_news && read(ends[0], &number, 1) == 1) {
        if (number == 0) {
          is_ending = true;
        } else if (seen.insert(number).second) {
          until[number] = Clock::now() + same_signal;
          begin_call(number);
        } else if (!until.contains(number) || Clock::now() >= until[number]) {
          set_handler(number, SIG_DFL);
          kill(getpid(), number);
        }
      }
      give_back_due();
    }
    if (latest.valid()) latest.wait();
  }
};

SignalWatcher::SignalWatcher(const std::vector<int>& signals, std::function<void(int)> call) : impl_(std::make_unique<Impl>()) {
  impl_->call = std::move(call);
  if (pipe2(impl_->ends, O_CLOEXEC) != 0) return;
  fcntl(impl_->ends[1], F_SETFL, O_NONBLOCK);
  write_end = impl_->ends[1];
  impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
  for (const int number : signals) {
    struct sigaction present {};
    if (sigaction(number, nullptr, &present) != 0 || present.sa_handler != SIG_DFL) continue;
    set_handler(number, &handle);
    impl_->signals.push_back(number);
  }
}

SignalWatcher::~SignalWatcher() {
  if (!impl_->thread.joinable()) return;
  const unsigned char end = 0;
  [[maybe_unused]] const auto written = write(impl_->ends[1], &end, 1);
  impl_->thread.join();
  for (const int number : impl_->signals) {
    struct sigaction present {};
    if (sigaction(number, nullptr, &present) == 0 && present.sa_handler == &handle) set_handler(number, SIG_DFL);
  }
  write_end = -1;
  close(impl_->ends[0]);
  close(impl_->ends[1]);
}

}  // namespace rt

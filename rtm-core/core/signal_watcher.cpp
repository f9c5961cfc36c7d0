#include "core/signal_watcher.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <thread>

namespace rt {
namespace {

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

  void run() {
    pthread_setname_np(pthread_self(), "rtm-signals");
    for (;;) {
      unsigned char number = 0;
      const auto size = read(ends[0], &number, 1);
      if (size < 0 && errno == EINTR) continue;
      if (size <= 0 || number == 0) return;
      set_handler(number, SIG_DFL);
      call(number);
    }
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
  for (const int number : impl_->signals) {
    struct sigaction present {};
    if (sigaction(number, nullptr, &present) == 0 && present.sa_handler == &handle) set_handler(number, SIG_DFL);
  }
  const unsigned char end = 0;
  [[maybe_unused]] const auto written = write(impl_->ends[1], &end, 1);
  impl_->thread.join();
  write_end = -1;
  close(impl_->ends[0]);
  close(impl_->ends[1]);
}

}  // namespace rt

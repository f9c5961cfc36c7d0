#include "core/signal_watcher.h"

#include <pthread.h>
#include <semaphore.h>
#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <ctime>
#include <future>
#include <map>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

namespace rt {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds same_signal{50};  // as `timeout` sends two: to its child, and to the child's process group

// From the handler to the watcher, without a descriptor: a process whose component has closed all descriptors can still be ended. Number 0
// is no signal: it ends the watcher.
struct News {
  News() { sem_init(&count, 0, 0); }
  void forget() {
    while (sem_trywait(&count) == 0) continue;
    for (auto& number : numbers) number = 0;
  }
  sem_t count{};
  std::array<std::atomic<unsigned>, NSIG> numbers{};
};
News news;

void handle(int number) {
  const int saved = errno;
  news.numbers[static_cast<std::size_t>(number)].fetch_add(1, std::memory_order_relaxed);  // the semaphore orders it
  sem_post(&news.count);
  errno = saved;
}

// One that has arrived; -1: none within this time. Without a time it waits for one.
int next_number(std::optional<std::chrono::milliseconds> longest) {
  timespec end{};
  if (longest) {
    clock_gettime(CLOCK_MONOTONIC, &end);
    end.tv_nsec += longest->count() * 1'000'000;
    end.tv_sec += end.tv_nsec / 1'000'000'000;
    end.tv_nsec %= 1'000'000'000;
  }
  while ((longest ? sem_clockwait(&news.count, CLOCK_MONOTONIC, &end) : sem_wait(&news.count)) != 0)
    if (errno != EINTR) return -1;
  // The end comes after the signals before it.
  for (std::size_t i = 1; i <= news.numbers.size(); ++i) {
    const std::size_t number = i % news.numbers.size();
    if (news.numbers[number].load(std::memory_order_relaxed) == 0) continue;
    news.numbers[number].fetch_sub(1, std::memory_order_relaxed);
    return static_cast<int>(number);
  }
  return -1;
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
      const int number = next_number(until.empty() ? std::nullopt : std::optional(same_signal));
      if (number == 0) {
        is_ending = true;
      } else if (number > 0 && seen.insert(number).second) {
        until[number] = Clock::now() + same_signal;
        begin_call(number);
      } else if (number > 0 && (!until.contains(number) || Clock::now() >= until[number])) {
        set_handler(number, SIG_DFL);
        kill(getpid(), number);
      }
      give_back_due();
    }
    if (latest.valid()) latest.wait();
  }
};

SignalWatcher::SignalWatcher(const std::vector<int>& signals, std::function<void(int)> call) : impl_(std::make_unique<Impl>()) {
  impl_->call = std::move(call);
  news.forget();
  impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
  for (const int number : signals) {
    struct sigaction present {};
    if (sigaction(number, nullptr, &present) != 0 || present.sa_handler != SIG_DFL) continue;
    set_handler(number, &handle);
    impl_->signals.push_back(number);
  }
}

SignalWatcher::~SignalWatcher() {
  handle(0);
  impl_->thread.join();
  for (const int number : impl_->signals) {
    struct sigaction present {};
    if (sigaction(number, nullptr, &present) == 0 && present.sa_handler == &handle) set_handler(number, SIG_DFL);
  }
}

}  // namespace rt

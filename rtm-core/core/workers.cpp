#include "core/workers.h"

#include <sys/prctl.h>

namespace rt {

namespace {

// The kernel may delay a sleeper by its timer slack, 50 us by default.
void make_this_thread_punctual() { prctl(PR_SET_TIMERSLACK, 1UL); }

}  // namespace

void PeriodicWorker::run() {
  make_this_thread_punctual();
  cycle_ = std::chrono::steady_clock::now();
  while (true) {
    shared_.lock()->woken = false;  // before the context is looked at, so that no later request is missed
    steps_.transit();
    if (context_.is_idle()) {
      if (!sleep_while_idle()) return;
      cycle_ = std::chrono::steady_clock::now();
      continue;
    }
    steps_.execute_and_update();
    if (!wait_for_deadline()) return;
  }
}

bool PeriodicWorker::sleep_while_idle() {
  auto data = shared_.lock();
  while (!data->stopping && !data->woken)
    data.wait_until(condition_, std::chrono::steady_clock::now() + std::chrono::hours(24), [&] { return data->stopping || data->woken; });
  return !data->stopping;
}

bool PeriodicWorker::wait_for_deadline() {
  while (true) {
    const auto period = context_.period();
    const auto deadline = cycle_ + period;
    {
      auto data = shared_.lock();
      if (data->stopping) return false;
      // Without a sleep there is no time for extra transitions either: the next cycle makes them.
      if (std::chrono::steady_clock::now() >= deadline ||
          !data.wait_until(condition_, deadline, [&] { return data->stopping || data->woken; })) {
        cycle_ = deadline;
        break;
      }
      if (data->stopping) return false;
      data->woken = false;
    }
    steps_.transit();
    if (context_.is_idle()) return true;
  }
  const auto period = context_.period();
  const auto late = (std::chrono::steady_clock::now() - cycle_) / period;
  if (late > most_late_periods) {
    cycle_ += late * period;
    context_.count_missed(static_cast<std::uint64_t>(late));
  }
  return true;
}

void PeriodicWorker::stop() {
  shared_.lock()->stopping = true;
  condition_.notify_all();
}

void PeriodicWorker::reset() { *shared_.lock() = Data{}; }

void PeriodicWorker::wake() {
  shared_.lock()->woken = true;
  condition_.notify_all();
}

bool PeriodicWorker::is_stopping() const { return shared_.lock()->stopping; }

void TriggeredWorker::run() {
  while (true) {
    bool ticked = false;
    {
      auto data = shared_.lock();
      while (!data->stopping && !data->woken && data->ticks == 0)
        data.wait_until(condition_, std::chrono::steady_clock::now() + std::chrono::hours(24),
                        [&] { return data->stopping || data->woken || data->ticks > 0; });
      if (data->stopping) return;
      ticked = data->ticks > 0;
      if (ticked) --data->ticks;
      data->woken = false;
    }
    steps_.transit();
    if (ticked) steps_.execute_and_update();
  }
}

void TriggeredWorker::stop() {
  shared_.lock()->stopping = true;
  condition_.notify_all();
}

void TriggeredWorker::reset() { *shared_.lock() = Data{}; }

void TriggeredWorker::wake() {
  shared_.lock()->woken = true;
  condition_.notify_all();
}

void TriggeredWorker::tick() {
  if (!context_.is_running()) return;
  ++shared_.lock()->ticks;
  condition_.notify_all();
}

bool Turns::begin() {
  const auto self = std::this_thread::get_id();
  auto data = shared_.lock();
  if (data->taken && data->taker == self) return false;
  while (data->taken) data.wait_until(condition_, std::chrono::steady_clock::now() + std::chrono::hours(24), [&] { return !data->taken; });
  data->taken = true;
  data->taker = self;
  return true;
}

void Turns::end() {
  shared_.lock()->taken = false;
  condition_.notify_one();
}

}  // namespace rt

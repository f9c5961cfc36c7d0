#include "core/workers.h"

#include <sys/prctl.h>

#include <cerrno>
#include <ctime>
#include <optional>
#include <utility>

#include "base/waiting.h"

namespace rt {

namespace {

// The kernel may delay a sleeper by its timer slack, 50 us by default.
void make_this_thread_punctual() { prctl(PR_SET_TIMERSLACK, 1UL); }

}  // namespace

bool Alarm::wait_until(std::chrono::steady_clock::time_point deadline) {
  const auto since = deadline.time_since_epoch();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since);
  const timespec time{static_cast<time_t>(seconds.count()), static_cast<long>(std::chrono::nanoseconds(since - seconds).count())};
  while (sem_clockwait(&rings_, CLOCK_MONOTONIC, &time) != 0) {
    if (errno != EINTR) return false;
  }
  return true;
}

PeriodicWorker::PeriodicWorker(ExecutionContext& context, Steppable& steps, const SteadyTime& time)
    : context_(context), steps_(steps), time_(time), jump_(time.on_jump([this] { alarm_.ring(); })) {}

void PeriodicWorker::run() {
  make_this_thread_punctual();
  cycle_ = time_.now();
  waited_ = base::time_waited();
  while (true) {
    shared_.lock()->woken = false;  // before the context is looked at, so that no later request is missed
    steps_.transit();
    if (context_.is_idle()) {
      if (!sleep_while_idle()) return;
      cycle_ = time_.now();
      continue;
    }
    steps_.execute_and_update();
    if (!wait_for_deadline()) return;
  }
}

bool PeriodicWorker::sleep_while_idle() {
  while (true) {
    {
      auto data = shared_.lock();
      if (data->stopping) return !(data->has_left = true);
      if (data->woken) return true;
    }
    alarm_.wait_until(std::chrono::steady_clock::now() + std::chrono::hours(24));
  }
}

bool PeriodicWorker::wait_for_deadline() {
  // Who waits for others is not late: the period begins when the wait ends. Who does so for longer than its period runs at the beat of the
  // others, so what passes of its periods while a busy machine lets it wait once more is no loss.
  const auto waited = base::time_waited() - std::exchange(waited_, base::time_waited());
  const bool has_own_beat = waited < context_.period();
  cycle_ += waited;
  while (true) {
    const auto period = context_.period();
    const auto deadline = cycle_ + period;
    // Without a sleep there is no time for extra transitions either: the next cycle makes them.
    const bool is_over = time_.now() >= deadline || (!alarm_.wait_until(time_.look_again(deadline)) && time_.now() >= deadline);
    {
      auto data = shared_.lock();
      if (data->stopping) return !(data->has_left = true);
      if (is_over) {
        cycle_ = deadline;
        break;
      }
      if (!std::exchange(data->woken, false)) continue;
    }
    steps_.transit();
    if (context_.is_idle()) return true;
  }
  const auto period = context_.period();
  const auto late = (time_.now() - cycle_) / period;
  if (late > max_late_periods) {
    cycle_ += late * period;
    if (has_own_beat) context_.count_missed(static_cast<std::uint64_t>(late));
  }
  return true;
}

void PeriodicWorker::stop() {
  shared_.lock()->stopping = true;
  alarm_.ring();
}

bool PeriodicWorker::resume() {
  auto data = shared_.lock();
  if (data->has_left) return false;
  data->stopping = false;
  return true;
}

void PeriodicWorker::reset() { *shared_.lock() = Data{}; }

void PeriodicWorker::wake() {
  if (!std::exchange(shared_.lock()->woken, true)) alarm_.ring();
}

bool PeriodicWorker::is_stopping() const { return shared_.lock()->stopping; }

void TriggeredWorker::run() {
  shared_.lock()->thread = std::this_thread::get_id();
  while (true) {
    std::optional<std::chrono::nanoseconds> tick;
    {
      auto data = shared_.lock();
      while (!data->stopping && !data->woken && data->ticks.empty())
        data.wait_until(condition_, std::chrono::steady_clock::now() + std::chrono::hours(24),
                        [&] { return data->stopping || data->woken || !data->ticks.empty(); });
      data->has_left = data->stopping;
      if (data->stopping) return;
      if (!data->ticks.empty()) {
        tick = data->ticks.front();
        data->ticks.pop_front();
      }
      data->woken = false;
    }
    if (tick) steps_.begin_tick(*tick);
    steps_.transit();
    if (!tick) continue;
    steps_.execute_and_update();
    ++shared_.lock()->over;
    cycles_.notify_all();
  }
}

void TriggeredWorker::stop() {
  shared_.lock()->stopping = true;
  condition_.notify_all();
  cycles_.notify_all();
}

bool TriggeredWorker::resume() {
  auto data = shared_.lock();
  if (data->has_left) return false;
  data->stopping = false;
  return true;
}

bool TriggeredWorker::is_stopping() const { return shared_.lock()->stopping; }

void TriggeredWorker::reset() {
  auto data = shared_.lock();
  *data = Data{.taken = data->taken, .over = data->taken};
  cycles_.notify_all();
}

void TriggeredWorker::wake() {
  shared_.lock()->woken = true;
  condition_.notify_all();
}

// Its number; nothing when it is forgotten.
std::optional<std::uint64_t> TriggeredWorker::take(std::chrono::nanoseconds time) {
  if (!context_.is_running()) return std::nullopt;
  std::optional<std::uint64_t> number;
  {
    auto data = shared_.lock();
    if (data->ticks.size() < max_waiting) {
      data->ticks.push_back(time);
      number = ++data->taken;
    }
  }
  condition_.notify_all();
  if (!number) context_.count_missed(1);
  return number;
}

void TriggeredWorker::tick(std::chrono::nanoseconds time) { (void)take(time); }

void TriggeredWorker::tick_and_wait(std::chrono::nanoseconds time) {
  const auto number = take(time);
  if (!number) return;
  auto data = shared_.lock();
  const auto is_over = [&] { return data->over >= *number || data->stopping; };
  while (data->thread != std::this_thread::get_id() && !is_over())
    data.wait_until(cycles_, std::chrono::steady_clock::now() + std::chrono::hours(24), is_over);
}

void ThreadPool::start(std::size_t threads, std::function<void(std::size_t, int)> work) {
  stop();
  *shared_.lock() = Data{};
  work_ = std::move(work);
  for (std::size_t i = 1; i <= threads; ++i) threads_.emplace_back([this, i] { serve(i); });
}

void ThreadPool::serve(std::size_t number) {
  make_this_thread_punctual();
  std::uint64_t seen = 0;
  while (true) {
    int job = 0;
    {
      auto data = shared_.lock();
      while (!data->stopping && data->round == seen)
        data.wait_until(begins_, std::chrono::steady_clock::now() + std::chrono::hours(24),
                        [&] { return data->stopping || data->round != seen; });
      if (data->stopping) return;
      seen = data->round;
      job = data->job;
    }
    work_(number, job);
    bool is_last = false;
    {
      auto data = shared_.lock();
      is_last = --data->busy == 0;
    }
    if (is_last) done_.notify_all();
  }
}

void ThreadPool::run(int job, const std::function<void()>& own) {
  {
    auto data = shared_.lock();
    ++data->round;
    data->job = job;
    data->busy = threads_.size();
  }
  begins_.notify_all();
  own();
  auto data = shared_.lock();
  while (data->busy > 0) data.wait_until(done_, std::chrono::steady_clock::now() + std::chrono::hours(24), [&] { return data->busy == 0; });
}

void ThreadPool::stop() {
  shared_.lock()->stopping = true;
  begins_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  threads_.clear();
}

bool CallSerializer::begin() {
  const auto self = std::this_thread::get_id();
  auto data = shared_.lock();
  if (data->taken && data->taker == self) return false;
  while (data->taken) data.wait_until(condition_, std::chrono::steady_clock::now() + std::chrono::hours(24), [&] { return !data->taken; });
  data->taken = true;
  data->taker = self;
  return true;
}

void CallSerializer::end() {
  shared_.lock()->taken = false;
  condition_.notify_one();
}

}  // namespace rt

#include "coil/Timer.h"

#include <algorithm>
#include <vector>

namespace coil {

Timer::Timer(TimeValue interval) : interval_(std::max(std::chrono::nanoseconds(interval), std::chrono::nanoseconds(1000))) {}

Timer::~Timer() {
  stop();
  join();
}

void Timer::start() {
  join();  // The thread of an earlier start, if it has been stopped.
  std::lock_guard lock(mutex_);
  if (is_running_ || thread_.joinable()) return;
  is_running_ = true;
  thread_ = std::thread([this] { run(); });
}

void Timer::stop() {
  std::lock_guard lock(mutex_);
  is_running_ = false;
  changed_.notify_all();
}

void Timer::join() {
  std::thread ending;
  {
    std::lock_guard lock(mutex_);
    if (is_running_ || !thread_.joinable() || thread_.get_id() == std::this_thread::get_id()) return;
    ending = std::move(thread_);
  }
  ending.join();
}

void Timer::invoke() {
  std::vector<std::shared_ptr<ListenerBase>> due;
  {
    std::lock_guard lock(mutex_);
    for (Entry& entry : entries_) {
      entry.remains -= interval_;
      if (entry.remains > std::chrono::nanoseconds::zero()) continue;
      entry.remains = std::max(entry.remains + entry.period, std::chrono::nanoseconds(1));
      due.push_back(entry.listener);
    }
  }
  for (auto& listener : due) listener->invoke();
}

ListenerId Timer::registerListener(ListenerBase* listener, TimeValue period) {
  if (listener == nullptr) return nullptr;
  std::lock_guard lock(mutex_);
  for (Entry& entry : entries_) {
    if (entry.listener.get() != listener) continue;
    entry.period = entry.remains = period;
    return listener;
  }
  entries_.push_back({std::shared_ptr<ListenerBase>(listener), period, period});
  return listener;
}

ListenerId Timer::registerListenerFunc(std::function<void()> callback, TimeValue period) {
  return registerListener(std::make_unique<ListenerFunc>(std::move(callback)).release(), period);
}

bool Timer::unregisterListener(ListenerId id) {
  std::list<Entry> before;  // a listener that ends here ends without the lock
  std::lock_guard lock(mutex_);
  before = entries_;
  return std::erase_if(entries_, [id](const Entry& entry) { return entry.listener.get() == id; }) != 0;
}

void Timer::run() {
  auto due = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  while (is_running_) {
    due = std::max(due + interval_, std::chrono::steady_clock::now());
    if (changed_.wait_until(lock, due, [this] { return !is_running_; })) return;
    lock.unlock();
    invoke();
    lock.lock();
  }
}

}  // namespace coil

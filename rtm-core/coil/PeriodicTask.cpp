#include "coil/PeriodicTask.h"

#include <algorithm>

namespace coil {

PeriodicTask::PeriodicTask() = default;

PeriodicTask::~PeriodicTask() {
  finalize();
  if (thread_.joinable()) thread_.detach();  // Only when the function destroys its own task.
}

void PeriodicTask::activate() {
  std::unique_lock lock(mutex_);
  if (is_alive_ || !function_) return;
  if (thread_.joinable()) {  // Finalized from its own thread before.
    std::thread old = std::move(thread_);
    lock.unlock();
    old.join();
    lock.lock();
  }
  is_alive_ = true;
  thread_ = std::thread([this] { run(); });
}

void PeriodicTask::finalize() {
  std::thread ending;
  {
    std::lock_guard lock(mutex_);
    is_alive_ = false;
    changed_.notify_all();
    if (thread_.joinable() && thread_.get_id() != std::this_thread::get_id()) ending = std::move(thread_);
  }
  if (ending.joinable()) ending.join();
}

int PeriodicTask::suspend() {
  std::lock_guard lock(mutex_);
  is_suspended_ = true;
  changed_.notify_all();
  return 0;
}

int PeriodicTask::resume() {
  std::lock_guard lock(mutex_);
  is_suspended_ = false;
  changed_.notify_all();
  return 0;
}

void PeriodicTask::signal() {
  std::lock_guard lock(mutex_);
  is_signalled_ = true;
  changed_.notify_all();
}

bool PeriodicTask::setTask(TaskFuncBase* func, bool delete_in_dtor) {
  if (func == nullptr) return false;
  std::shared_ptr<TaskFuncBase> shared(func, [delete_in_dtor](TaskFuncBase* f) {
    if (delete_in_dtor) delete f;
  });
  return setTask(std::function<void()>([shared] { (*shared)(); }));
}

bool PeriodicTask::setTask(std::function<void()> func) {
  if (!func) return false;
  std::lock_guard lock(mutex_);
  function_.swap(func);  // the one before ends without the lock
  return true;
}

void PeriodicTask::setPeriod(double period) {
  const double seconds = period > 0 ? std::min(period, 9e9) : 0;  // 9e9 s fit into 64-bit nanoseconds.
  std::lock_guard lock(mutex_);
  period_ = std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(seconds));
  changed_.notify_all();
}

void PeriodicTask::setPeriod(TimeValue period) { setPeriod(period.getDouble()); }

void PeriodicTask::executionMeasure(bool value) {
  std::lock_guard lock(mutex_);
  measures_execution_ = value;
}

void PeriodicTask::executionMeasureCount(int n) {
  std::lock_guard lock(mutex_);
  execution_ = TimeMeasure(static_cast<unsigned long>(std::max(n, 1)));
}

void PeriodicTask::periodicMeasure(bool value) {
  std::lock_guard lock(mutex_);
  measures_period_ = value;
}

void PeriodicTask::periodicMeasureCount(int n) {
  std::lock_guard lock(mutex_);
  between_ = TimeMeasure(static_cast<unsigned long>(std::max(n, 1)));
}

TimeMeasure::Statistics PeriodicTask::getExecStat() {
  std::lock_guard lock(mutex_);
  return execution_.getStatistics();
}

TimeMeasure::Statistics PeriodicTask::getPeriodStat() {
  std::lock_guard lock(mutex_);
  return between_.getStatistics();
}

void PeriodicTask::run() {
  std::unique_lock lock(mutex_);
  const std::function<void()> function = function_;
  auto due = Clock::now();
  while (wait_for_turn(lock, due)) {
    if (measures_period_) {
      between_.tack();
      between_.tick();
    }
    if (measures_execution_) execution_.tick();
    lock.unlock();
    function();
    lock.lock();
    if (measures_execution_) execution_.tack();
  }
}

// False when the thread shall end. Deadlines are absolute, so the rate has no drift; missed ones are left out.
bool PeriodicTask::wait_for_turn(std::unique_lock<std::mutex>& lock, Clock::time_point& due) {
  while (is_alive_) {
    if (is_suspended_) {
      changed_.wait(lock, [this] { return !is_alive_ || !is_suspended_ || is_signalled_; });
      due = Clock::now();
      if (is_alive_ && is_signalled_) {
        is_signalled_ = false;
        return true;
      }
      continue;
    }
    is_signalled_ = false;
    if (period_ <= std::chrono::nanoseconds::zero()) return true;
    if (Clock::now() >= due) {
      due = std::max(due + period_, Clock::now());
      return true;
    }
    due = std::min(due, Clock::now() + period_);
    changed_.wait_until(lock, due);
  }
  return false;
}

}  // namespace coil

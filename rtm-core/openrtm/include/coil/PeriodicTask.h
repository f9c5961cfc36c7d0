// Runs a function in a thread of its own: periodically, back to back (period 0), or once per signal() while suspended. Any thread.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "coil/PeriodicTaskBase.h"
#include "coil/TimeMeasure.h"

namespace coil {

class PeriodicTask : public PeriodicTaskBase {
 public:
  PeriodicTask();
  ~PeriodicTask() override;
  PeriodicTask(const PeriodicTask&) = delete;
  PeriodicTask& operator=(const PeriodicTask&) = delete;

  // Starts the thread. Does nothing if there is no function yet or the thread is running.
  void activate() override;
  // Ends the thread after the call that is under way, and waits for it unless it is the caller. Can be activated again.
  void finalize() override;
  // Takes effect after the call that is under way.
  int suspend() override;
  int resume() override;
  // Runs the function once more when suspended. No signal is lost: one that comes while the function runs makes it run again.
  void signal() override;

  using PeriodicTaskBase::setTask;
  // Functions are set before activate(); false for an empty one.
  bool setTask(TaskFuncBase* func, bool delete_in_dtor = true) override;
  bool setTask(std::function<void()> func) override;
  // Seconds; 0 or less runs back to back.
  void setPeriod(double period) override;
  void setPeriod(TimeValue period) override;
  template <class R, class P>
  void setPeriod(std::chrono::duration<R, P> period) {
    setPeriod(std::chrono::duration<double>(period).count());
  }

  void executionMeasure(bool value) override;
  // Keeps the last n lengths.
  void executionMeasureCount(int n) override;
  void periodicMeasure(bool value) override;
  void periodicMeasureCount(int n) override;
  TimeMeasure::Statistics getExecStat() override;
  TimeMeasure::Statistics getPeriodStat() override;

 private:
  using Clock = std::chrono::steady_clock;

  void run();
  bool wait_for_turn(std::unique_lock<std::mutex>& lock, Clock::time_point& due);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> function_;
  std::chrono::nanoseconds period_{};
  bool is_alive_ = false;
  bool is_suspended_ = false;
  bool is_signalled_ = false;
  bool measures_execution_ = true;
  bool measures_period_ = true;
  TimeMeasure execution_{1000};
  TimeMeasure between_{1000};
  std::thread thread_;
};

}  // namespace coil

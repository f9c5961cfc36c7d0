// A thread that runs tasks, once or at a period. Any thread may use it. A task that throws is logged and stays scheduled.
// Tasks run one after the other: they must be short or have the runner for themselves.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/steady_time.h"

namespace rt {

class TaskRunner {
 public:
  using TaskId = std::uint64_t;

  // `name` is that of the thread in process listings, at most 15 characters.
  explicit TaskRunner(const std::string& name, const SteadyTime& time = machine_time());
  // As stop().
  ~TaskRunner();
  TaskRunner(const TaskRunner&) = delete;
  TaskRunner& operator=(const TaskRunner&) = delete;

  // First after `delay`, then every `period` (absolute deadlines; missed ones are skipped). Period 0: once.
  TaskId add(std::function<void()> task, std::chrono::nanoseconds period, std::chrono::nanoseconds delay);
  // False if it is not scheduled. Waits for a run in progress, except when called by the task itself.
  bool remove(TaskId id);
  void post(std::function<void()> task) { add(std::move(task), {}, {}); }
  // Returns when every task that was posted before has run; at once on the runner's own thread or when it has stopped.
  void drain();
  bool is_own_thread() const;
  // Ends the thread after the task in progress (waits for it, except on the runner's own thread); later tasks are dropped.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace rt

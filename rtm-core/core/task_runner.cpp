#include "core/task_runner.h"

#include <pthread.h>

#include <condition_variable>
#include <exception>
#include <future>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "base/log.h"

namespace rt {
namespace {

using Time = std::chrono::steady_clock::time_point;

struct Task {
  std::shared_ptr<const std::function<void()>> call;
  std::chrono::nanoseconds period;
};

}  // namespace

struct TaskRunner::Impl {
  std::string name;
  std::mutex mutex;
  std::condition_variable changed;
  std::map<std::pair<Time, TaskId>, Task> tasks;  // the earliest first
  TaskId last_id = 0;
  TaskId running = 0;
  bool running_removed = false;
  bool stopping = false;
  std::thread thread;

  void run() {
    pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
    std::unique_lock lock(mutex);
    while (!stopping) {
      if (tasks.empty()) {
        changed.wait(lock);
        continue;
      }
      const auto when = tasks.begin()->first.first;
      if (when > std::chrono::steady_clock::now()) {
        changed.wait_until(lock, when);
        continue;
      }
      run_first(lock);
    }
  }

  void run_first(std::unique_lock<std::mutex>& lock) {
    const auto [when, id] = tasks.begin()->first;
    Task task = tasks.begin()->second;
    tasks.erase(tasks.begin());
    running = id;
    running_removed = false;
    lock.unlock();
    try {
      (*task.call)();
    } catch (const std::exception& e) {
      base::log(base::Level::error, name, "a task failed: {}", e.what());
    } catch (...) {
      base::log(base::Level::error, name, "a task failed with an unknown exception");
    }
    if (task.period.count() == 0) task.call.reset();  // what it captured dies without the lock
    lock.lock();
    running = 0;
    if (task.call && !running_removed) {
      const auto now = std::chrono::steady_clock::now();
      auto next = when + task.period;
      if (next < now) next += (now - next) / task.period * task.period + task.period;
      tasks.emplace(std::pair(next, id), std::move(task));
    }
    changed.notify_all();
  }
};

TaskRunner::TaskRunner(const std::string& name) : impl_(std::make_unique<Impl>()) {
  impl_->name = name;
  impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
}

TaskRunner::~TaskRunner() { stop(); }

TaskRunner::TaskId TaskRunner::add(std::function<void()> task, std::chrono::nanoseconds period, std::chrono::nanoseconds delay) {
  auto call = std::make_shared<const std::function<void()>>(std::move(task));
  const std::scoped_lock lock(impl_->mutex);
  const auto id = ++impl_->last_id;
  if (!impl_->stopping) impl_->tasks.emplace(std::pair(std::chrono::steady_clock::now() + delay, id), Task{std::move(call), period});
  impl_->changed.notify_all();
  return id;
}

bool TaskRunner::remove(TaskId id) {
  Task doomed;
  std::unique_lock lock(impl_->mutex);
  for (auto at = impl_->tasks.begin(); at != impl_->tasks.end(); ++at) {
    if (at->first.second != id) continue;
    doomed = std::move(at->second);
    impl_->tasks.erase(at);
    return true;
  }
  if (impl_->running != id) return false;
  impl_->running_removed = true;
  if (!is_own_thread()) impl_->changed.wait(lock, [&] { return impl_->running != id; });
  return true;
}

void TaskRunner::drain() {
  if (is_own_thread()) return;
  auto done = std::make_shared<std::promise<void>>();
  auto is_done = done->get_future();
  {
    const std::scoped_lock lock(impl_->mutex);
    if (impl_->stopping) return;
  }
  add([done] { done->set_value(); }, {}, {});
  done.reset();
  is_done.wait();  // also when the task is dropped: the promise breaks
}

bool TaskRunner::is_own_thread() const { return impl_->thread.get_id() == std::this_thread::get_id(); }

void TaskRunner::stop() {
  std::map<std::pair<Time, TaskId>, Task> dropped;
  {
    const std::scoped_lock lock(impl_->mutex);
    impl_->stopping = true;
    dropped.swap(impl_->tasks);
  }
  impl_->changed.notify_all();
  dropped.clear();
  if (!is_own_thread() && impl_->thread.joinable()) impl_->thread.join();
}

}  // namespace rt

#include "core/task_runner.h"

#include <pthread.h>

#include <condition_variable>
#include <exception>
#include <future>
#include <map>
#include <optional>
#include <thread>
#include <utility>

#include "base/guarded.h"
#include "base/log.h"

namespace rt {
namespace {

using Time = SteadyTime::Point;

struct Task {
  std::shared_ptr<const std::function<void()>> call;
  std::chrono::nanoseconds period;
};

}  // namespace

struct TaskRunner::Impl {
  struct State {
    std::map<std::pair<Time, TaskId>, Task> tasks;  // the earliest first
    TaskId last_id = 0;
    TaskId running = 0;
    bool running_removed = false;
    bool stopping = false;
  };
  struct Due {
    Time when;
    TaskId id;
    Task task;
  };
  std::string name;
  const SteadyTime& time;
  base::Guarded<State, base::Rank::tasks> shared;
  std::condition_variable changed;
  std::shared_ptr<void> jump;
  std::thread thread;

  Impl(const std::string& n, const SteadyTime& t) : name(n), time(t) {
    jump = time.on_jump([this] {
      { const auto seen = shared.lock(); }  // see SteadyTime::on_jump
      changed.notify_all();
    });
  }

  void run() {
    pthread_setname_np(pthread_self(), name.substr(0, 15).c_str());
    while (auto due = next()) run(std::move(*due));
  }

  // Waits for the time of the earliest task; none when the runner stops.
  std::optional<Due> next() {
    auto state = shared.lock();
    while (!state->stopping) {
      const auto when = state->tasks.empty() ? Time::max() : state->tasks.begin()->first.first;
      if (when <= time.now()) {
        auto first = state->tasks.extract(state->tasks.begin());
        state->running = first.key().second;
        state->running_removed = false;
        return Due{when, state->running, std::move(first.mapped())};
      }
      const auto is_changed = [&] {
        return state->stopping || (state->tasks.empty() ? Time::max() : state->tasks.begin()->first.first) != when;
      };
      if (when == Time::max()) {
        state.wait(changed, is_changed);
      } else {
        state.wait_until(changed, time.look_again(when), [&] { return is_changed() || time.now() >= when; });
      }
    }
    return std::nullopt;
  }

  void run(Due due) {
    try {
      (*due.task.call)();
    } catch (const std::exception& e) {
      base::log(base::Level::error, name, "a task failed: {}", e.what());
    } catch (...) {
      base::log(base::Level::error, name, "a task failed with an unknown exception");
    }
    if (due.task.period.count() == 0) due.task.call.reset();  // what it captured dies without the lock
    {
      auto state = shared.lock();
      state->running = 0;
      if (due.task.call && !state->running_removed && !state->stopping) {
        const auto now = time.now();
        auto next = due.when + due.task.period;
        if (next < now) next += (now - next) / due.task.period * due.task.period + due.task.period;
        state->tasks.emplace(std::pair(next, due.id), std::move(due.task));
      }
    }
    changed.notify_all();
  }
};

TaskRunner::TaskRunner(const std::string& name, const SteadyTime& time) : impl_(std::make_unique<Impl>(name, time)) {
  impl_->thread = std::thread([impl = impl_.get()] { impl->run(); });
}

TaskRunner::~TaskRunner() { stop(); }

TaskRunner::TaskId TaskRunner::add(std::function<void()> task, std::chrono::nanoseconds period, std::chrono::nanoseconds delay) {
  auto call = std::make_shared<const std::function<void()>>(std::move(task));
  TaskId id = 0;
  {
    auto state = impl_->shared.lock();
    id = ++state->last_id;
    if (!state->stopping) state->tasks.emplace(std::pair(impl_->time.now() + delay, id), Task{std::move(call), period});
  }
  impl_->changed.notify_all();
  return id;  // a task that came too late dies without the lock
}

bool TaskRunner::remove(TaskId id) {
  Task doomed;  // dies without the lock
  auto state = impl_->shared.lock();
  for (auto at = state->tasks.begin(); at != state->tasks.end(); ++at) {
    if (at->first.second != id) continue;
    doomed = std::move(at->second);
    state->tasks.erase(at);
    return true;
  }
  if (state->running != id) return false;
  state->running_removed = true;
  if (!is_own_thread()) state.wait(impl_->changed, [&] { return state->running != id; });
  return true;
}

void TaskRunner::drain() {
  if (is_own_thread()) return;
  auto done = std::make_shared<std::promise<void>>();
  auto is_done = done->get_future();
  if (impl_->shared.lock()->stopping) return;
  add([done] { done->set_value(); }, {}, {});
  done.reset();
  is_done.wait();  // also when the task is dropped: the promise breaks
}

bool TaskRunner::is_own_thread() const { return impl_->thread.get_id() == std::this_thread::get_id(); }

void TaskRunner::stop() {
  std::map<std::pair<Time, TaskId>, Task> dropped;
  {
    auto state = impl_->shared.lock();
    state->stopping = true;
    dropped.swap(state->tasks);
  }
  impl_->changed.notify_all();
  dropped.clear();
  if (!is_own_thread() && impl_->thread.joinable()) impl_->thread.join();
}

}  // namespace rt

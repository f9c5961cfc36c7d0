#include "physics/worker_pool.h"

#include <chrono>
#include <system_error>

namespace sim {
namespace {

// [us]. Apart, so that the choice does not flutter.
constexpr double worth_sharing = 150;
constexpr double not_worth_sharing = 60;

}  // namespace

WorkerPool::WorkerPool(int threads, Sharing sharing) : sharing_(sharing) {
  try {
    for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { work(); });
  } catch (const std::system_error&) {
    // No room for more threads: those that there are do all of the work, with the same result.
  }
}

WorkerPool::~WorkerPool() {
  parts_.lock()->is_ending = true;
  started_.notify_all();
  for (auto& worker : workers_) worker.join();
}

bool WorkerPool::take_parts() {
  bool has_run = false;
  while (true) {
    const std::function<void(std::size_t)>* part = nullptr;
    std::size_t mine = 0;
    {
      auto parts = parts_.lock();
      if (has_run) --parts->running;
      if (parts->next >= parts->count) return parts->running == 0;
      mine = parts->next++;
      ++parts->running;
      part = parts->part;
    }
    (*part)(mine);
    has_run = true;
  }
}

void WorkerPool::work() {
  while (true) {
    {
      auto parts = parts_.lock();
      parts.wait(started_, [&] { return parts->is_ending || parts->next < parts->count; });
      if (parts->is_ending) return;
    }
    if (take_parts()) finished_.notify_one();
  }
}

void WorkerPool::run(std::size_t count, const std::function<void(std::size_t)>& part) {
  if (workers_.empty() || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) part(i);
    return;
  }
  {
    auto parts = parts_.lock();
    parts->part = &part;
    parts->next = 0;
    parts->count = count;
  }
  started_.notify_all();
  static_cast<void>(take_parts());
  auto parts = parts_.lock();
  parts.wait(finished_, [&] { return parts->running == 0 && parts->next >= parts->count; });
  parts->count = parts->next = 0;
  parts->part = nullptr;
}

void WorkerPool::run(std::size_t count, const std::function<void(std::size_t)>& part, Pace& pace) {
  if (sharing_ == Sharing::always) return run(count, part);
  const auto start = std::chrono::steady_clock::now();
  if (pace.is_shared) {
    run(count, part);
  } else {
    for (std::size_t i = 0; i < count; ++i) part(i);
  }
  const double taken = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
  pace.microseconds += (taken - pace.microseconds) / 8;
  const bool is_to_be_shared = pace.microseconds > (pace.is_shared ? not_worth_sharing : worth_sharing);
  if (is_to_be_shared == pace.is_shared) return;
  pace.is_shared = is_to_be_shared;
  pace.microseconds = (worth_sharing + not_worth_sharing) / 2;
}

}  // namespace sim

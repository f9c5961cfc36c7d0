#include "physics/worker_pool.h"

#include <chrono>

namespace sim {
namespace {

// [us]. Apart, so that the choice does not flutter.
constexpr double worth_sharing = 150;
constexpr double not_worth_sharing = 60;

}  // namespace

WorkerPool::WorkerPool(int threads, Sharing sharing) : sharing_(sharing) {
  for (int i = 1; i < threads; ++i) workers_.emplace_back([this] { work(); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
  }
  started_.notify_all();
  for (auto& worker : workers_) worker.join();
}

void WorkerPool::take_parts(std::unique_lock<std::mutex>& lock) {
  while (next_ < count_) {
    const std::size_t mine = next_++;
    ++running_;
    const auto& part = *part_;
    lock.unlock();
    part(mine);
    lock.lock();
    --running_;
  }
}

void WorkerPool::work() {
  std::unique_lock lock(mutex_);
  while (!is_ending_) {
    started_.wait(lock, [&] { return is_ending_ || next_ < count_; });
    take_parts(lock);
    if (running_ == 0) finished_.notify_one();
  }
}

void WorkerPool::run(std::size_t count, const std::function<void(std::size_t)>& part) {
  if (workers_.empty() || count <= 1) {
    for (std::size_t i = 0; i < count; ++i) part(i);
    return;
  }
  std::unique_lock lock(mutex_);
  part_ = &part;
  next_ = 0;
  count_ = count;
  lock.unlock();
  started_.notify_all();
  lock.lock();
  take_parts(lock);
  finished_.wait(lock, [&] { return running_ == 0 && next_ >= count_; });
  count_ = next_ = 0;
  part_ = nullptr;
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

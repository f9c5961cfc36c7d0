#include "coil/Task.h"

#include <limits.h>

#include <condition_variable>
#include <mutex>
#include <system_error>

namespace coil {

// What a kept thread and its task share. The thread may outlive the task that hangs in svc().
struct Task::Kept {
  std::mutex mutex;  // of all that follows; nothing is called under it
  std::condition_variable changed;
  Task* task = nullptr;  // null: it is gone
  bool is_due = false;   // svc() is to be called
  bool is_busy = false;  // from activate() until svc() has returned
};

Task::Task() = default;

Task::~Task() {
  bool is_idle = false;
  if (kept_) {
    const std::lock_guard lock(kept_->mutex);
    kept_->task = nullptr;
    is_idle = !kept_->is_busy;
    kept_->changed.notify_all();
  }
  if (!thread_) return;
  if (is_idle && !pthread_equal(*thread_, pthread_self()))
    pthread_join(*thread_, nullptr);
  else
    pthread_detach(*thread_);
}

int Task::open(void* /*args*/) { return 0; }
int Task::close(unsigned long /*flags*/) { return 0; }
int Task::svc() { return 0; }

void Task::keepThread() {
  if (kept_) return;
  kept_ = std::make_shared<Kept>();
  kept_->task = this;
}

void Task::activate() {
  if (is_running_.exchange(true)) return;
  if (!kept_) {
    if (thread_) pthread_join(*thread_, nullptr);  // The thread of an earlier activation has ended.
    thread_.reset();
    start(&Task::run, this);
    return;
  }
  {
    const std::lock_guard lock(kept_->mutex);
    kept_->is_due = kept_->is_busy = true;
    kept_->changed.notify_all();
  }
  if (thread_) return;
  auto argument = std::make_unique<std::shared_ptr<Kept>>(kept_);
  start(&Task::run_again_and_again, argument.get());
  static_cast<void>(argument.release());  // the thread has it
}

void Task::start(void* (*body)(void*), void* argument) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  if (stack_size_ != 0) pthread_attr_setstacksize(&attributes, stack_size_);
  pthread_t thread;
  const int failed = pthread_create(&thread, &attributes, body, argument);
  pthread_attr_destroy(&attributes);
  if (failed != 0) {
    if (kept_) {
      const std::lock_guard lock(kept_->mutex);
      kept_->is_due = kept_->is_busy = false;
    }
    is_running_ = false;
    throw std::system_error(failed, std::generic_category(), "no thread could be made");
  }
  thread_ = thread;
}

void* Task::run(void* task) noexcept {
  static_cast<Task*>(task)->svc();
  static_cast<Task*>(task)->finalize();
  return nullptr;
}

void* Task::run_again_and_again(void* argument) noexcept {
  const std::unique_ptr<std::shared_ptr<Kept>> owned(static_cast<std::shared_ptr<Kept>*>(argument));
  Kept& kept = **owned;
  std::unique_lock lock(kept.mutex);
  while (true) {
    kept.changed.wait(lock, [&] { return !kept.task || kept.is_due; });
    if (!kept.task) return nullptr;
    kept.is_due = false;
    Task* const task = kept.task;
    lock.unlock();
    task->svc();
    lock.lock();
    if (!kept.task) return nullptr;  // let go while it was in svc()
    task->reset();
    kept.is_busy = false;
    kept.changed.notify_all();
  }
}

int Task::wait() {
  if (!thread_ || pthread_equal(*thread_, pthread_self())) return 0;
  if (kept_) {
    std::unique_lock lock(kept_->mutex);
    kept_->changed.wait(lock, [&] { return !kept_->is_busy; });
    return 0;
  }
  pthread_join(*thread_, nullptr);
  thread_.reset();
  return 0;
}

bool Task::setStackSize(std::size_t octets) {
  if (octets != 0 && octets < static_cast<std::size_t>(PTHREAD_STACK_MIN)) return false;
  stack_size_ = octets;
  return true;
}

int Task::suspend() { return 0; }
int Task::resume() { return 0; }
void Task::reset() { is_running_ = false; }
void Task::finalize() { reset(); }

}  // namespace coil

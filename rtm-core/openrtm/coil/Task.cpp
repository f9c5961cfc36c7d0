#include "coil/Task.h"

#include <limits.h>

#include <system_error>

namespace coil {

Task::Task() = default;

Task::~Task() {
  if (thread_) pthread_detach(*thread_);
}

int Task::open(void* /*args*/) { return 0; }
int Task::close(unsigned long /*flags*/) { return 0; }
int Task::svc() { return 0; }

void Task::activate() {
  if (is_running_.exchange(true)) return;
  if (thread_) pthread_join(*thread_, nullptr);  // The thread of an earlier activation has ended.
  thread_.reset();
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  if (stack_size_ != 0) pthread_attr_setstacksize(&attributes, stack_size_);
  pthread_t thread;
  const int failed = pthread_create(&thread, &attributes, &Task::run, this);
  pthread_attr_destroy(&attributes);
  if (failed != 0) {
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

int Task::wait() {
  if (!thread_ || pthread_equal(*thread_, pthread_self())) return 0;
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

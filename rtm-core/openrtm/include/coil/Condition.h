// The condition variable of the 1.x API, bound to a mutex that the caller holds while waiting. Any thread.
#pragma once

#include <chrono>
#include <condition_variable>

#include "coil/NonCopyable.h"

namespace coil {

template <class M>
class Condition : private NonCopyable {
 public:
  explicit Condition(M& mutex) : mutex_(mutex) {}
  void signal() { condition_.notify_one(); }
  void broadcast() { condition_.notify_all(); }
  bool wait() {
    condition_.wait(mutex_);
    return true;
  }
  // False when the time is over.
  bool wait(long second, long nano_second = 0) {
    return condition_.wait_for(mutex_, std::chrono::seconds(second) + std::chrono::nanoseconds(nano_second)) == std::cv_status::no_timeout;
  }

 private:
  std::condition_variable_any condition_;
  M& mutex_;
};

}  // namespace coil

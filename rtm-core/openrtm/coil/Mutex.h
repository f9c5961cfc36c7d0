// The mutex of the 1.x API. Any thread.
#pragma once

#include <mutex>

#include "coil/NonCopyable.h"

namespace coil {

class Mutex : private NonCopyable {
 public:
  explicit Mutex(const char* /*name*/ = nullptr) {}
  void lock() { mutex_.lock(); }
  void unlock() { mutex_.unlock(); }
  // True if the mutex is now held by the caller.
  bool trylock() { return mutex_.try_lock(); }
  bool try_lock() { return mutex_.try_lock(); }

 private:
  std::mutex mutex_;
};

}  // namespace coil

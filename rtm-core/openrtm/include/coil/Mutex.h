// The mutex of the 1.x API, which is also one of 2.x. Any thread.
#pragma once

#include <mutex>

namespace coil {

class Mutex : public std::mutex {
 public:
  explicit Mutex(const char* /*name*/ = nullptr) {}
  // True if the mutex is now held by the caller.
  bool trylock() { return try_lock(); }
};

}  // namespace coil

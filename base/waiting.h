// Measures the time in which a callback waits for others, for data or for the simulator. Execution contexts separate it from work in their
// statistics, and a cycle that waited is not late. Each thread has its own account.
#pragma once

#include <chrono>

namespace base {

// Counts its life as waiting. Not to be nested.
class ScopedWait {
 public:
  ScopedWait() : start_(std::chrono::steady_clock::now()) {}
  ~ScopedWait();
  ScopedWait(const ScopedWait&) = delete;
  ScopedWait& operator=(const ScopedWait&) = delete;

 private:
  std::chrono::steady_clock::time_point start_;
};

// How long this thread has waited so far; it only grows.
std::chrono::nanoseconds time_waited();

}  // namespace base

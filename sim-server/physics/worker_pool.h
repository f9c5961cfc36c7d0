// Runs the parts of one piece of work on several threads: the caller's own and `threads - 1` more. Which thread does which part is not
// defined, so the parts must not depend on each other. run() is for one thread at a time.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <functional>
#include <thread>
#include <vector>

#include "base/guarded.h"

namespace sim {

class WorkerPool {
 public:
  // Of work that is done again and again: how long it takes, and so whether other threads are worth waking for it. The parts of a run of a
  // few dozen microseconds are done before the others have woken up and got the lock.
  struct Pace {
    double microseconds = 0;  // smoothed
    bool is_shared = false;
  };

  enum class Sharing { when_worth_it, always };

  // At least 1; 1 has no thread of its own and runs everything in the caller's.
  explicit WorkerPool(int threads, Sharing sharing = Sharing::when_worth_it);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  int threads() const { return static_cast<int>(workers_.size()) + 1; }
  // part(0) .. part(count - 1), each once; returns when all are done. The parts do not throw.
  void run(std::size_t count, const std::function<void(std::size_t)>& part);
  // As run, in the caller's thread alone while that is quicker and nobody said otherwise.
  void run(std::size_t count, const std::function<void(std::size_t)>& part, Pace& pace);

 private:
  void work();
  // Takes parts until none is left; true when none runs any more.
  bool take_parts();

  struct Parts {
    const std::function<void(std::size_t)>* part = nullptr;
    std::size_t next = 0, count = 0, running = 0;
    bool is_ending = false;
  };
  base::Guarded<Parts, base::Rank::worker> parts_;
  std::condition_variable started_, finished_;
  Sharing sharing_;
  std::vector<std::thread> workers_;
};

}  // namespace sim

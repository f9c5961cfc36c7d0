// Detects the exit of processes at once, by pidfds in one thread. Any thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <thread>

#include "base/guarded.h"
#include "base/result.h"
#include "shm/layout.h"

namespace shm {

// A process under watch.
class Watched {
 public:
  explicit Watched(const ProcessMark& mark) : mark_(mark) {}
  const ProcessMark& mark() const { return mark_; }
  // One load, except for processes that the kernel would not let us watch: then the process table is asked.
  bool is_dead() const;

 private:
  friend class ProcessWatch;
  ProcessMark mark_;
  std::atomic<bool> dead_{false};
  std::atomic<bool> is_polled_{false};
};

class ProcessWatch {
 public:
  static base::Result<std::unique_ptr<ProcessWatch>> start();
  ~ProcessWatch();

  // The same object for the same process. A process that is dead already comes back dead.
  std::shared_ptr<const Watched> watch(const ProcessMark& mark);
  // Number of deaths seen so far: changes when a watched process has died.
  std::uint64_t deaths() const { return deaths_.load(std::memory_order_acquire); }  // pairs with the release in the thread
  // Called from the watching thread after each death. When this returns the callback before is no longer running; not to be called from it.
  void on_death(std::function<void()> callback);

 private:
  struct State;
  ProcessWatch();
  void run();
  std::unique_ptr<State> state_;
  std::atomic<std::uint64_t> deaths_{0};
  std::thread thread_;
};

}  // namespace shm

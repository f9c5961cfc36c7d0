// What drives an execution context on a thread: PeriodicWorker at its rate, TriggeredWorker once per tick, Turns on whatever thread comes.
// run() belongs to one thread; everything else may be called from any thread. The thread itself is the caller's.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <thread>

#include "base/guarded.h"
#include "core/execution_context.h"

namespace rt {

// Each phase as the owner wants it called, with its clock set. Steps a context.
class Steps {
 public:
  virtual ~Steps() = default;
  virtual void transit() = 0;
  virtual void execute_and_update() = 0;
};

// Absolute deadlines: a late cycle is followed at once by the next until the delay is made good; more than 10 whole periods are given up
// and counted as missed. Sleeps while the context is idle. A request wakes it: transitions do not wait for the period.
class PeriodicWorker {
 public:
  static constexpr std::int64_t most_late_periods = 10;

  PeriodicWorker(ExecutionContext& context, Steps& steps) : context_(context), steps_(steps) {}

  // Until stop().
  void run();
  void stop();
  // Allows run() again after stop().
  void reset();
  void wake();
  bool is_stopping() const;

 private:
  struct Data {
    bool stopping = false;
    bool woken = false;
  };
  // False when stopping.
  bool sleep_while_idle();
  bool wait_for_deadline();

  ExecutionContext& context_;
  Steps& steps_;
  base::Guarded<Data, base::Rank::buffer> shared_;
  std::condition_variable condition_;
  std::chrono::steady_clock::time_point cycle_{};  // when the present cycle should have begun; run() only
};

// As many cycles as ticks. A request is answered without a tick.
class TriggeredWorker {
 public:
  TriggeredWorker(ExecutionContext& context, Steps& steps) : context_(context), steps_(steps) {}

  void run();
  void stop();
  void reset();
  void wake();
  // Ticks of a stopped context are forgotten.
  void tick();

 private:
  struct Data {
    bool stopping = false;
    bool woken = false;
    std::uint64_t ticks = 0;
  };

  ExecutionContext& context_;
  Steps& steps_;
  base::Guarded<Data, base::Rank::buffer> shared_;
  std::condition_variable condition_;
};

// Lets one thread after the other step a context.
class Turns {
 public:
  // Waits for its turn and calls the function; false, and nothing is called, when this thread has its turn already.
  template <class Function>
  bool take(Function function) {
    if (!begin()) return false;
    function();
    end();
    return true;
  }

 private:
  struct Data {
    bool taken = false;
    std::thread::id taker{};
  };
  bool begin();
  void end();

  base::Guarded<Data, base::Rank::buffer> shared_;
  std::condition_variable condition_;
};

}  // namespace rt

// Drivers of an execution context on a thread: PeriodicWorker at its rate, TriggeredWorker once per tick, CallSerializer on the thread of
// any caller; a ThreadPool steps its lanes at the same time. run() belongs to one thread; everything else may be called from any thread.
// Their threads are the caller's, except a ThreadPool's. Of a context the thread is rtm/ContextThread.h.
#pragma once

#include <semaphore.h>

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "base/guarded.h"
#include "core/execution_context.h"
#include "core/steady_time.h"

namespace rt {

// The stages of a cycle, called with the owner's clock. Steppable a context.
class Steppable {
 public:
  virtual ~Steppable() = default;
  // A TriggeredWorker begins the cycle of a tick that brought this time.
  virtual void begin_tick(std::chrono::nanoseconds) {}
  virtual void transit() = 0;
  virtual void execute_and_update() = 0;
};

// The loop of a thread that steps a context. run() belongs to the thread; everything else may be called from any thread.
class Worker {
 public:
  virtual ~Worker() = default;
  // Until stop().
  virtual void run() = 0;
  virtual void stop() = 0;
  // Takes stop() back for a thread that has not noticed; false when run() has returned or is about to.
  virtual bool resume() = 0;
  // Allows run() again after stop(). Forgets ticks that wait.
  virtual void reset() = 0;
  virtual void wake() = 0;
  virtual bool is_stopping() const = 0;
};

// Wakes one sleeper. A condition variable would cost a cycle one system call more: it leaves the mutex marked as waited for, and the next
// unlock looks for the waiter. Any thread; one waits.
class Alarm {
 public:
  Alarm() { sem_init(&rings_, 0, 0); }
  ~Alarm() { sem_destroy(&rings_); }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  // Not lost if nobody waits: it ends the next wait.
  void ring() { sem_post(&rings_); }
  // False at the deadline; true also for a ring from long ago.
  bool wait_until(std::chrono::steady_clock::time_point deadline);

 private:
  sem_t rings_;
};

// Absolute deadlines: a late cycle is followed at once by the next until the delay is made good; more than 10 whole periods are given up
// and counted as missed. Time in which a callback waits (base/waiting.h) makes no cycle late. Sleeps while the context is idle. A request
// wakes it: transitions do not wait for the period.
class PeriodicWorker final : public Worker {
 public:
  static constexpr std::int64_t max_late_periods = 10;

  PeriodicWorker(ExecutionContext& context, Steppable& steps, const SteadyTime& time = machine_time());

  void run() override;
  void stop() override;
  bool resume() override;
  void reset() override;
  void wake() override;
  bool is_stopping() const override;

 private:
  struct Data {
    bool stopping = false;
    bool has_left = false;
    bool woken = false;
  };
  // False when stopping.
  bool sleep_while_idle();
  bool wait_for_deadline();

  ExecutionContext& context_;
  Steppable& steps_;
  const SteadyTime& time_;
  base::Guarded<Data, base::Rank::worker> shared_;
  Alarm alarm_;
  SteadyTime::Point cycle_{};           // when the present cycle should have begun; run() only
  std::chrono::nanoseconds waited_{0};  // by this thread, before it; run() only
  const std::shared_ptr<void> jump_;    // rings the alarm; last: it ends first
};

// As many cycles as ticks, in their order. A request is answered without a tick.
class TriggeredWorker final : public Worker {
 public:
  // Ticks that wait; more of them are not taken and counted as missed.
  static constexpr std::size_t max_waiting = 100'000;

  TriggeredWorker(ExecutionContext& context, Steppable& steps) : context_(context), steps_(steps) {}

  void run() override;
  void stop() override;
  bool resume() override;
  void reset() override;
  void wake() override;
  bool is_stopping() const override;
  // Any thread, several at once. Ticks of a stopped context are forgotten.
  void tick(std::chrono::nanoseconds time = {});
  // The same, and returns when its cycle is over, or the worker stops. From within a cycle it returns at once.
  void tick_and_wait(std::chrono::nanoseconds time);

 private:
  struct Data {
    bool stopping = false;
    bool has_left = false;
    bool woken = false;
    std::deque<std::chrono::nanoseconds> ticks{};
    std::uint64_t taken = 0, over = 0;  // ticks so far; those that are forgotten are over
    std::thread::id thread{};           // of run()
  };
  std::optional<std::uint64_t> take(std::chrono::nanoseconds time);

  ExecutionContext& context_;
  Steppable& steps_;
  base::Guarded<Data, base::Rank::worker> shared_;
  std::condition_variable condition_;
  std::condition_variable cycles_;  // for those who wait for the end of one
};

// Does jobs on several threads of its own at once. start, run and stop are called by one thread at a time.
class ThreadPool {
 public:
  ~ThreadPool() { stop(); }
  // `work` is called with the number of the thread, from 1, and the job.
  void start(std::size_t threads, std::function<void(std::size_t, int)> work);
  // Lets all threads do the job; `own` runs here meanwhile. Returns when all are done.
  void run(int job, const std::function<void()>& own);
  void stop();

 private:
  struct Data {
    std::uint64_t round = 0;
    int job = 0;
    std::size_t busy = 0;
    bool stopping = false;
  };
  void serve(std::size_t number);

  std::function<void(std::size_t, int)> work_;
  std::vector<std::thread> threads_;
  base::Guarded<Data, base::Rank::worker> shared_;
  std::condition_variable begins_, done_;
};

// Lets one thread after the other step a context.
class CallSerializer {
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

  base::Guarded<Data, base::Rank::worker> shared_;
  std::condition_variable condition_;
};

}  // namespace rt

// An object with a thread of its own: derive and override svc(). activate() and wait() are called by one thread at a time.
#pragma once

#include <pthread.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>

#include "coil/NonCopyable.h"

namespace coil {

class Task : private NonCopyable {
 public:
  Task();
  // A thread that is still running is let go; stop it and wait() first.
  virtual ~Task();

  virtual int open(void* args = nullptr);
  virtual int close(unsigned long flags = 0);
  // The body of the thread.
  virtual int svc();
  // Starts the thread; does nothing while one is running.
  virtual void activate();
  // Returns when the thread has ended; at once if there is none or it is the caller.
  virtual int wait();
  // Kept for 1.x sources; a thread can't be stopped from outside.
  virtual int suspend();
  virtual int resume();
  virtual void reset();
  virtual void finalize();

 protected:
  // For the next activate(); 0: what the system gives. False when that is less than the system needs at least.
  bool setStackSize(std::size_t octets);
  // The thread waits for the next activate() when svc() has returned, so that what svc() keeps for its thread (thread_local) is still
  // there. It ends with the task. Before the first activate().
  void keepThread();

 private:
  struct Kept;
  static void* run(void* task) noexcept;
  // For one that is kept.
  static void* run_again_and_again(void* kept) noexcept;
  void start(void* (*body)(void*), void* argument);

  std::atomic<bool> is_running_{false};
  std::optional<pthread_t> thread_;
  std::size_t stack_size_ = 0;
  std::shared_ptr<Kept> kept_;  // null: each activation has a thread of its own
};

}  // namespace coil

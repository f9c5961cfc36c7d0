// The locks of the project. Any thread.
//   Guarded   owns its data: the data can be reached only while the lock is held.
//   Turn      guards no data; its owner may do what one thread at a time may do, such as calling a library with global buffers.
//   UsersTurn a Turn in which code of users is called. That code can take any lock.
// Guarded and Turn have ranks; a thread may take one only if its rank is higher than that of every other it has (asserted in builds without
// NDEBUG). Code of users, the network, the log and the file system are never called while data is held: take a snapshot, release, then
// act. Where such calls leave us, expect_no_data_held() asserts it.
#pragma once

#include <cassert>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

namespace base {

// What a lock guards, outermost first: the order in which a thread may take several.
enum class Rank : int {
  turn = 5,        // no data: one thread at a time
  manager = 10,    // the state of a manager or of a whole program
  component = 20,  // a component, its configuration, the members of its contexts
  context = 30,    // the states of those whom a context calls, its place in the lock step
  port = 40,       // a port, its open calls
  connector = 50,  // the connections of a port; one connection
  callbacks = 60,  // who runs the callbacks of a component
  worker = 62,     // what a thread does, and whether it is to go on
  queue = 64,      // jobs, messages and samples that wait for a thread
  samples = 66,    // samples that wait for a reader; the newest ones
  details = 68,    // one fact of an object that others may replace: profile and clock of a connection, a fault
  objects = 70,    // tables of objects of this process by name or key
  peers = 73,      // other processes: who is connected, watched, bound, or still to be told
  profile = 76,    // properties of a component that its author reads as well
  tasks = 79,      // threads that serve others, and what they are asked for
  memory = 82,     // blocks and streams to be used again
  noted = 85,      // counts, times, and what is said or found only once
  log = 90         // the log, and what it asks for: clock, caller, settings
};

namespace detail {

// What the calling thread holds; kept in builds without NDEBUG only.
struct Held {
  int rank = 0;  // the highest
  int data = 0;  // how many Guarded
};
inline Held& held() {
  thread_local Held mine;
  return mine;
}

class HeldRank {
 public:
  enum class Kind { data, turn };
  HeldRank([[maybe_unused]] Rank rank, [[maybe_unused]] Kind kind) {
#ifndef NDEBUG
    assert(static_cast<int>(rank) > held().rank && "locks must be taken in ascending rank");
    previous_ = std::exchange(held(), {static_cast<int>(rank), held().data + (kind == Kind::data ? 1 : 0)});
#endif
  }
  ~HeldRank() {
#ifndef NDEBUG
    held() = previous_;
#endif
  }
  HeldRank(const HeldRank&) = delete;
  HeldRank& operator=(const HeldRank&) = delete;

 private:
#ifndef NDEBUG
  Held previous_;
#endif
};

}  // namespace detail

// Before a call that may take long, or may come back: the calling thread must hold no data (asserted in builds without NDEBUG).
inline void expect_no_data_held() { assert(detail::held().data == 0 && "called while data is held"); }

template <class T, Rank rank>
class Guarded {
 public:
  class Lock {
   public:
    T* operator->() { return &owner_.data_; }
    T& operator*() { return owner_.data_; }

    // Waits until predicate() or the time-out; true when the predicate holds.
    template <class Predicate>
    bool wait_for(std::condition_variable& condition, std::chrono::nanoseconds timeout, Predicate predicate) {
      return condition.wait_until(lock_, std::chrono::steady_clock::now() + timeout, std::move(predicate));
    }
    template <class Predicate>
    bool wait_until(std::condition_variable& condition, std::chrono::steady_clock::time_point deadline, Predicate predicate) {
      return condition.wait_until(lock_, deadline, std::move(predicate));
    }
    // For threads that sleep between their tasks: somebody is sure to notify.
    template <class Predicate>
    void wait(std::condition_variable& condition, Predicate predicate) {
      condition.wait(lock_, std::move(predicate));
    }
    // False when the thread is asked to stop and predicate() does not hold.
    template <class Predicate>
    bool wait(std::condition_variable_any& condition, const std::stop_token& stop, Predicate predicate) {
      return condition.wait(lock_, stop, std::move(predicate));
    }

   private:
    friend class Guarded;
    explicit Lock(Guarded& owner) : owner_(owner), held_(rank, detail::HeldRank::Kind::data), lock_(owner.mutex_) {}
    Guarded& owner_;
    detail::HeldRank held_;
    std::unique_lock<std::mutex> lock_;
  };

  class ConstLock {
   public:
    const T* operator->() const { return &owner_.data_; }
    const T& operator*() const { return owner_.data_; }

   private:
    friend class Guarded;
    explicit ConstLock(const Guarded& owner) : owner_(owner), held_(rank, detail::HeldRank::Kind::data), lock_(owner.mutex_) {}
    const Guarded& owner_;
    detail::HeldRank held_;
    std::unique_lock<std::mutex> lock_;
  };

  Guarded() = default;
  explicit Guarded(T data) : data_(std::move(data)) {}

  [[nodiscard]] Lock lock() { return Lock(*this); }
  [[nodiscard]] ConstLock lock() const { return ConstLock(*this); }
  // A copy of the data, taken under the lock.
  T snapshot() const { return *lock(); }

 private:
  mutable std::mutex mutex_;
  T data_{};
};

// What is done in a turn may take long and may call a library, the log or the file system, where that is what the turn is for. It must not
// come back for the same turn, so code of users is not called in one.
template <Rank rank = Rank::turn>
class Turn {
 public:
  class Mine {
   private:
    friend class Turn;
    explicit Mine(Turn& owner) : held_(rank, detail::HeldRank::Kind::turn), lock_(owner.mutex_) {}
    detail::HeldRank held_;
    std::unique_lock<std::mutex> lock_;
  };

  // Waits for it; it ends with the result.
  [[nodiscard]] Mine take() { return Mine(*this); }

 private:
  std::mutex mutex_;
};

// Nobody knows what code of users asks for, or waits for, so such a turn has no rank. Instead the thread that has it may take it again, and
// whoever waits for it gives up after a time: what would be a dead lock is an error.
class UsersTurn {
 public:
  using Mine = std::unique_lock<std::recursive_timed_mutex>;

  // None when it did not come in time. No data may be held.
  [[nodiscard]] std::optional<Mine> take(std::chrono::nanoseconds timeout) {
    expect_no_data_held();
#ifdef __SANITIZE_THREAD__
    Mine mine(mutex_, std::chrono::system_clock::now() + timeout);  // gcc 12's sanitizer does not know pthread_mutex_clocklock
#else
    Mine mine(mutex_, timeout);
#endif
    if (!mine) return std::nullopt;
    return mine;
  }

 private:
  std::recursive_timed_mutex mutex_;
};

}  // namespace base

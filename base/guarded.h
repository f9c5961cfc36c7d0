// The locks of the project. Any thread.
//   Guarded   a mutex with its data. The data can be accessed only while the lock is held.
//   Turn      a lock section without data: its owner uses a resource that allows one thread at a time, such as a library with global
//   buffers. UsersTurn a Turn in which user code is called. That code can acquire any lock.
// Guarded and Turn have ranks. A thread may acquire a lock only if its rank is above the ranks of all locks that it holds (asserted in
// builds without NDEBUG). Never call user code, the network, the log or the file system while a Guarded is held: take a snapshot, release
// the lock, then act. expect_no_data_held() asserts this at such calls.
#pragma once

#include <cassert>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <utility>

namespace base {

// Ranks, named by what the lock guards, outermost first. A thread acquires several locks in this order.
enum class Rank : int {
  turn = 5,        // no data: a lock section
  manager = 10,    // the state of a manager or of a whole program
  component = 20,  // a component, its configuration, the members of its contexts
  context = 30,    // the states of the members of a context, its slot in the lock step
  port = 40,       // a port, its open calls
  connector = 50,  // the connections of a port; one connection
  callbacks = 60,  // which thread runs the callbacks of a component
  worker = 62,     // the work of a thread, and whether it shall stop
  queue = 64,      // jobs, messages and samples that wait for a thread
  samples = 66,    // unread samples, latest samples
  details = 68,    // one replaceable property of an object: profile and clock of a connection, a fault
  objects = 70,    // tables of objects of this process by name or key
  peers = 73,      // other processes: connected, watched, bound, or waiting for a notification
  profile = 76,    // properties of a component that its author reads, too
  tasks = 79,      // service threads and their requests
  memory = 82,     // pools of blocks and streams
  noted = 85,      // counts, times, and what was reported once
  log = 90         // the log and its inputs: clock, caller, settings
};

namespace detail {

// The locks that the calling thread holds; only in builds without NDEBUG.
struct Held {
  int rank = 0;  // the highest rank
  int data = 0;  // number of Guarded
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

// Call it before a call that can block or call back: the calling thread must hold no Guarded (asserted in builds without NDEBUG).
inline void expect_no_data_held() { assert(detail::held().data == 0 && "called while data is held"); }

template <class T, Rank rank>
class Guarded {
 public:
  class Lock {
   public:
    T* operator->() { return &owner_.data_; }
    T& operator*() { return owner_.data_; }

    // Waits until predicate() is true or the timeout expires; returns predicate().
    template <class Predicate>
    bool wait_for(std::condition_variable& condition, std::chrono::nanoseconds timeout, Predicate predicate) {
      return condition.wait_until(lock_, std::chrono::steady_clock::now() + timeout, std::move(predicate));
    }
    template <class Predicate>
    bool wait_until(std::condition_variable& condition, std::chrono::steady_clock::time_point deadline, Predicate predicate) {
      return condition.wait_until(lock_, deadline, std::move(predicate));
    }
    // For threads that sleep between their tasks. Some other thread must notify.
    template <class Predicate>
    void wait(std::condition_variable& condition, Predicate predicate) {
      condition.wait(lock_, std::move(predicate));
    }
    // False if a stop of the thread was requested and predicate() is false.
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

// A lock section can take long. It may call the library, log or file system that it is for. It must not acquire the same Turn again, so it
// does not call user code.
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

  // Waits for the lock section. It ends with the destructor of the result.
  [[nodiscard]] Mine take() { return Mine(*this); }

 private:
  std::mutex mutex_;
};

// The locks and waits of user code are not known, so this lock section has no rank. Instead, its owner may acquire it again, and waiting
// for it has a timeout: a deadlock becomes an error.
class UsersTurn {
 public:
  using Mine = std::unique_lock<std::recursive_timed_mutex>;

  // Nothing after the timeout. The calling thread must hold no Guarded.
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

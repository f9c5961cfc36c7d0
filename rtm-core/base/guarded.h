// A lock that owns its data: the data can be reached only while the lock is held. Any thread.
// Locks have ranks; a thread may take a lock only if its rank is higher than that of every lock it holds (asserted in builds without
// NDEBUG). Never call user code, the network or the log while one is held: take a snapshot, release, then act.
#pragma once

#include <cassert>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace base {

// Outermost first.
enum class Rank : int { manager = 10, component = 20, context = 30, port = 40, connector = 50, buffer = 60, registry = 70, log = 90 };

namespace detail {
class HeldRank {
 public:
  explicit HeldRank([[maybe_unused]] Rank rank) {
#ifndef NDEBUG
    assert(static_cast<int>(rank) > current() && "locks must be taken in ascending rank");
    previous_ = std::exchange(current(), static_cast<int>(rank));
#endif
  }
  ~HeldRank() {
#ifndef NDEBUG
    current() = previous_;
#endif
  }
  HeldRank(const HeldRank&) = delete;
  HeldRank& operator=(const HeldRank&) = delete;

 private:
#ifndef NDEBUG
  static int& current() {
    thread_local int rank = 0;
    return rank;
  }
  int previous_ = 0;
#endif
};
}  // namespace detail

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

   private:
    friend class Guarded;
    explicit Lock(Guarded& owner) : owner_(owner), held_(rank), lock_(owner.mutex_) {}
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
    explicit ConstLock(const Guarded& owner) : owner_(owner), held_(rank), lock_(owner.mutex_) {}
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

}  // namespace base

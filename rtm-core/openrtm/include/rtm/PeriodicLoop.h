// The names that svc() of an author finds in the periodic context, of 1.x and 2.x. For the thread that runs svc, unless
// a member says otherwise.
#pragma once

#include <coil/Mutex.h>
#include <rtm/ExecutionContextWorker.h>
#include <rtm/idl/RTCStub.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <iterator>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace RTC {

class ExecutionContextBase;

namespace detail {

// Waits with the mutex that it was made with (1.x) or with a lock that the caller has (2.x). Waits end now and then without a signal. Any
// thread.
class LoopCondition {
 public:
  explicit LoopCondition(coil::Mutex& mutex) : mutex_(mutex) {}
  void signal() { condition_.notify_one(); }
  void broadcast() { condition_.notify_all(); }
  void notify_one() { condition_.notify_one(); }
  void notify_all() { condition_.notify_all(); }
  bool wait() {
    condition_.wait_for(mutex_, longest_);
    return true;
  }
  template <class Lock>
  void wait(Lock& lock) {
    condition_.wait_for(lock, longest_);
  }

 private:
  static constexpr std::chrono::milliseconds longest_{50};
  std::condition_variable_any condition_;
  coil::Mutex& mutex_;
};

// Whether the thread is to work or to wait.
struct LoopWorker {
  coil::Mutex mutex_;
  LoopCondition cond_{mutex_};
  std::atomic<bool> running_{true};
  // Does not wait for the mutex: loops hold it while they call components, which may hang or ask for transitions themselves. A loop that
  // has just seen running_ false and begins to wait sees it true when its wait ends by itself.
  void wake() {
    running_ = true;
    if (mutex_.try_lock()) mutex_.unlock();
    cond_.broadcast();
  }
};

// Under one name two things of different versions.
struct NamedWorker : RTC_impl::ExecutionContextWorker, LoopWorker {
  explicit NamedWorker(ExecutionContextBase& context) : ExecutionContextWorker(context) {}
};

// The state of a member, as 1.1 spells it; of nobody by default.
class LoopState {
 public:
  using Machine = std::shared_ptr<RTC_impl::RTObjectStateMachine>;
  struct States {
    Machine machine{};
    bool isIn(RTC::LifeCycleState state) const { return machine && machine->isCurrentState(state); }
    RTC::LifeCycleState getState() const { return machine ? machine->getState() : RTC::CREATED_STATE; }
    void goTo(RTC::LifeCycleState state) const {
      if (machine) machine->goTo(state);
    }
  };
  LoopState() = default;
  explicit LoopState(Machine machine) : m_sm{std::move(machine)} {}
  // One cycle of this member.
  void worker() const;
  bool is(RTC::LightweightRTObject_ptr component) const { return m_sm.machine && m_sm.machine->isEquivalent(component); }

  States m_sm{};
};

class LoopMembers;

// A member of the context. Nil where there is none.
struct LoopMember {
  RTC::LightweightRTObject_var _ref{};
  LoopState _sm{};
  LoopMembers* list = nullptr;
  bool is_first = false, is_last = false;
  // Its part of the cycle, which begins with the first and is counted with the last.
  void run() const;
};

// The members as they were at the last begin() or size(). Any thread.
class LoopMembers {
  using Snapshot = std::shared_ptr<const std::vector<LoopMember>>;

 public:
  class iterator {
   public:
    using iterator_category = std::forward_iterator_tag;
    using value_type = LoopMember;
    using difference_type = std::ptrdiff_t;
    using pointer = const LoopMember*;
    using reference = const LoopMember&;
    // The end.
    iterator() = default;
    explicit iterator(Snapshot members) : members_(std::move(members)) {}
    const LoopMember& operator*() const { return (*members_)[at_]; }
    const LoopMember* operator->() const { return &(*members_)[at_]; }
    iterator& operator++() {
      ++at_;
      return *this;
    }
    iterator operator++(int) {
      iterator before = *this;
      ++at_;
      return before;
    }
    bool operator==(const iterator& other) const { return is_end() || other.is_end() ? is_end() == other.is_end() : at_ == other.at_; }
    bool operator!=(const iterator& other) const { return !(*this == other); }

   private:
    bool is_end() const { return !members_ || at_ >= members_->size(); }
    Snapshot members_{};
    std::size_t at_ = 0;
  };

  explicit LoopMembers(ExecutionContextBase& context) : worker_(context) {}
  iterator begin() { return iterator(refresh()); }
  iterator end() { return {}; }
  std::size_t size() { return refresh()->size(); }
  LoopMember operator[](std::size_t at) const;

 private:
  friend struct LoopMember;
  Snapshot refresh();

  RTC_impl::ExecutionContextWorker worker_;
  mutable std::mutex mutex_;
  Snapshot members_ = std::make_shared<const std::vector<LoopMember>>();
  std::atomic<std::chrono::steady_clock::time_point> cycle_start_{};
  std::atomic<std::chrono::nanoseconds> waited_before_{};
};

}  // namespace detail
}  // namespace RTC

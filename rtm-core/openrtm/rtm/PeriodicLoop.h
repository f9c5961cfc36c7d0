// The names that an author's own svc() of a periodic context finds in its base class, of 1.x and 2.x. For the thread that runs svc, unless
// a member says otherwise.
#pragma once

#include <coil/Mutex.h>
#include <rtm/idl/RTCStub.h>

#include <condition_variable>
#include <cstddef>
#include <vector>

namespace RTC {

class ExecutionContextBase;

namespace detail {

// Waits with the mutex that it was made with (1.x) or with a lock that the caller has (2.x). Any thread.
class LoopCondition {
 public:
  explicit LoopCondition(coil::Mutex& mutex) : mutex_(mutex) {}
  void signal() { condition_.notify_one(); }
  void broadcast() { condition_.notify_all(); }
  void notify_one() { condition_.notify_one(); }
  void notify_all() { condition_.notify_all(); }
  bool wait() {
    condition_.wait(mutex_);
    return true;
  }
  template <class Lock>
  void wait(Lock& lock) {
    condition_.wait(lock);
  }

 private:
  std::condition_variable_any condition_;
  coil::Mutex& mutex_;
};

// The thread exists from start to stop only, so it is never told to pause.
struct LoopWorker {
  coil::Mutex mutex_;
  LoopCondition cond_{mutex_};
  bool running_ = true;
};

// A member of the context. Nil and no first one where there is none.
struct LoopMember {
  RTC::LightweightRTObject_var _ref;
  ExecutionContextBase* context = nullptr;  // of the first one
};

// The members as they were at the last begin() or size().
class LoopMembers {
 public:
  class iterator {
   public:
    iterator(const LoopMembers* members, std::size_t at) : members_(members), at_(at) {}
    const LoopMember& operator*() const { return (*members_)[at_]; }
    const LoopMember* operator->() const { return &(*members_)[at_]; }
    iterator& operator++() {
      ++at_;
      return *this;
    }
    iterator operator++(int) { return {members_, at_++}; }
    bool operator==(const iterator& other) const { return at_ == other.at_; }

   private:
    const LoopMembers* members_;
    std::size_t at_;
  };

  explicit LoopMembers(ExecutionContextBase& context) : context_(context) {}
  iterator begin();
  iterator end() { return {this, members_.size()}; }
  std::size_t size();
  const LoopMember& operator[](std::size_t at) const { return at < members_.size() ? members_[at] : none_; }

 private:
  ExecutionContextBase& context_;
  std::vector<LoopMember> members_;
  const LoopMember none_{};
};

}  // namespace detail
}  // namespace RTC

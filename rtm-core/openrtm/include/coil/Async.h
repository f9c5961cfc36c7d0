// One call of a member function in a thread of its own.
//   coil::Async* call = coil::AsyncInvoker(&object, &Class::function);  call->invoke();  ...  call->wait();  delete call;
#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <utility>

#include "coil/Task.h"

namespace coil {

class Async : public Task {
 public:
  virtual void invoke() = 0;
  virtual bool finished() = 0;
};

namespace detail {

class AsyncCall final : public Async {
 public:
  AsyncCall(std::function<void()> function, bool auto_delete) : function_(std::move(function)), auto_delete_(auto_delete) {}

  void invoke() override {
    if (!auto_delete_) return activate();
    // Nobody waits for this one, so its thread is nobody's: Task's own would still be written to while the call deletes itself.
    std::thread([this] {
      svc();
      delete this;
    }).detach();
  }
  bool finished() override { return finished_; }
  int svc() override {
    function_();
    finished_ = true;
    return 0;
  }

 private:
  std::function<void()> function_;
  const bool auto_delete_;
  std::atomic<bool> finished_{false};
};

}  // namespace detail

// The function may be a member function without arguments or take the object's address. With auto_delete the call deletes itself at its
// end, otherwise the caller deletes it after wait().
template <class Object, class Func>
Async* AsyncInvoker(Object* object, Func function, bool auto_delete = false) {
  return new detail::AsyncCall([object, function]() mutable { std::invoke(function, object); }, auto_delete);
}

}  // namespace coil

// Callbacks without arguments, as coil::Timer takes them.
#pragma once

#include <functional>
#include <utility>

namespace coil {

class ListenerBase {
 public:
  virtual ~ListenerBase() = default;
  virtual void invoke() = 0;
};

// Calls a member function of an object that it does not own.
template <class ListenerClass>
class ListenerObject : public ListenerBase {
 public:
  ListenerObject(ListenerClass* object, void (ListenerClass::*function)()) : object_(object), function_(function) {}
  void invoke() override { (object_->*function_)(); }

 private:
  ListenerClass* object_;
  void (ListenerClass::*function_)();
};

class ListenerFunc : public ListenerBase {
 public:
  ListenerFunc(std::function<void()> function) : function_(std::move(function)) {}
  void invoke() override { function_(); }

 private:
  std::function<void()> function_;
};

using Listener = ListenerFunc;

}  // namespace coil

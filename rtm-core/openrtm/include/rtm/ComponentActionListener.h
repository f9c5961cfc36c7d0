// Listeners for what happens to a component: before and after each callback, ports added and removed, contexts attached and detached, and
// the actions of a state machine. They are called on the thread that does the thing, without a lock.
#pragma once

#include <rtm/ListenerList.h>
#include <rtm/idl/ExtendedFsmServiceSkel.h>
#include <rtm/idl/RTCSkel.h>

#include <cstddef>
#include <cstdint>

namespace RTC {

using UniqueId = ExecutionContextHandle_t;

// 2.x writes the values with the name of their type, 1.x without.
enum PreComponentActionListenerType : std::uint8_t {
  PRE_ON_INITIALIZE,
  PRE_ON_FINALIZE,
  PRE_ON_STARTUP,
  PRE_ON_SHUTDOWN,
  PRE_ON_ACTIVATED,
  PRE_ON_DEACTIVATED,
  PRE_ON_ABORTING,
  PRE_ON_ERROR,
  PRE_ON_RESET,
  PRE_ON_EXECUTE,
  PRE_ON_STATE_UPDATE,
  PRE_ON_RATE_CHANGED,
  PRE_COMPONENT_ACTION_LISTENER_NUM
};
enum PostComponentActionListenerType : std::uint8_t {
  POST_ON_INITIALIZE,
  POST_ON_FINALIZE,
  POST_ON_STARTUP,
  POST_ON_SHUTDOWN,
  POST_ON_ACTIVATED,
  POST_ON_DEACTIVATED,
  POST_ON_ABORTING,
  POST_ON_ERROR,
  POST_ON_RESET,
  POST_ON_EXECUTE,
  POST_ON_STATE_UPDATE,
  POST_ON_RATE_CHANGED,
  POST_COMPONENT_ACTION_LISTENER_NUM
};
enum PortActionListenerType : std::uint8_t { ADD_PORT, REMOVE_PORT, PORT_ACTION_LISTENER_NUM };
enum ExecutionContextActionListenerType : std::uint8_t { EC_ATTACHED, EC_DETACHED, EC_ACTION_LISTENER_NUM };
enum PreFsmActionListenerType : std::uint8_t {
  PRE_ON_INIT,
  PRE_ON_ENTRY,
  PRE_ON_DO,
  PRE_ON_EXIT,
  PRE_ON_STATE_CHANGE,
  PRE_FSM_ACTION_LISTENER_NUM
};
enum PostFsmActionListenerType : std::uint8_t {
  POST_ON_INIT,
  POST_ON_ENTRY,
  POST_ON_DO,
  POST_ON_EXIT,
  POST_ON_STATE_CHANGE,
  POST_FSM_ACTION_LISTENER_NUM
};

using PreCompActionListenerType = PreComponentActionListenerType;
using PostCompActionListenerType = PostComponentActionListenerType;
using ECActionListenerType = ExecutionContextActionListenerType;

class PreComponentActionListener {
 public:
  virtual ~PreComponentActionListener() = default;
  virtual void operator()(UniqueId ec_id) = 0;
  static const char* toString(PreComponentActionListenerType type);
};
class PostComponentActionListener {
 public:
  virtual ~PostComponentActionListener() = default;
  virtual void operator()(UniqueId ec_id, ReturnCode_t ret) = 0;
  static const char* toString(PostComponentActionListenerType type);
};
class PortActionListener {
 public:
  virtual ~PortActionListener() = default;
  virtual void operator()(const RTC::PortProfile& profile) = 0;
  static const char* toString(PortActionListenerType type);
};
class ExecutionContextActionListener {
 public:
  virtual ~ExecutionContextActionListener() = default;
  virtual void operator()(UniqueId ec_id) = 0;
  static const char* toString(ExecutionContextActionListenerType type);
};
class PreFsmActionListener {
 public:
  virtual ~PreFsmActionListener() = default;
  virtual void operator()(const char* state) = 0;
  static const char* toString(PreFsmActionListenerType type);
};
class PostFsmActionListener {
 public:
  virtual ~PostFsmActionListener() = default;
  virtual void operator()(const char* state, ReturnCode_t ret) = 0;
  static const char* toString(PostFsmActionListenerType type);
};

// Lists of listeners, one per type of event.
template <class Type, class Listener, Type count>
class ListenerLists {
 public:
  ListenerList<Listener>& operator[](Type type) { return lists_[index(type)]; }
  const ListenerList<Listener>& operator[](Type type) const { return lists_[index(type)]; }
  static bool isValid(Type type) { return type < count; }

 private:
  static std::size_t index(Type type) { return static_cast<std::size_t>(type); }
  ListenerList<Listener> lists_[static_cast<std::size_t>(count)];
};

class ComponentActionListeners {
 public:
  ListenerLists<PreComponentActionListenerType, PreComponentActionListener, PRE_COMPONENT_ACTION_LISTENER_NUM> preaction_;
  ListenerLists<PostComponentActionListenerType, PostComponentActionListener, POST_COMPONENT_ACTION_LISTENER_NUM> postaction_;
  ListenerLists<PortActionListenerType, PortActionListener, PORT_ACTION_LISTENER_NUM> portaction_;
  ListenerLists<ExecutionContextActionListenerType, ExecutionContextActionListener, EC_ACTION_LISTENER_NUM> ecaction_;
};

class FsmActionListeners {
 public:
  ListenerLists<PreFsmActionListenerType, PreFsmActionListener, PRE_FSM_ACTION_LISTENER_NUM> preaction_;
  ListenerLists<PostFsmActionListenerType, PostFsmActionListener, POST_FSM_ACTION_LISTENER_NUM> postaction_;
};

// A listener of class Base that calls a member function of an object, which must outlive it.
template <class Base, class Object, class Function, class... Args>
class MemberListener final : public Base {
 public:
  MemberListener(Object& object, Function function) : object_(object), function_(function) {}
  void operator()(Args... args) override { (object_.*function_)(args...); }

 private:
  Object& object_;
  Function function_;
};

}  // namespace RTC

// State machines written as classes: FSM_TOP is the machine with its events as virtual functions, FSM_SUBSTATE a state below another. A
// state handles an event by overriding its function; setState<Other>() takes effect when the handler returns. A machine belongs to one
// thread at a time (events may be queued from any); its state may be asked for from any thread.
//
//   FSM_TOP(Top) { FSM_STATE(Top); virtual void open() {} };
//   FSM_SUBSTATE(Closed, Top) { FSM_STATE(Closed); void open() override { setState<Opened>(); } };
//   RTC::Machine<Top> machine(component);  machine->open();
#pragma once

#include <rtm/ExtendedFsmServiceProvider.h>
#include <rtm/RTObject.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <typeindex>
#include <vector>

namespace RTC {

namespace fsm {

class Engine;

// What every state has. onInit is called for the state that a transition leads to, after the onEntry of all states that are entered.
class StateBase {
 public:
  virtual ~StateBase() = default;
  virtual ReturnCode_t onInit() { return RTC_OK; }
  virtual ReturnCode_t onEntry() { return RTC_OK; }
  virtual ReturnCode_t onExit() { return RTC_OK; }

 protected:
  friend class Engine;
  Engine* engine_ = nullptr;
};

// A state class as data; one object per class.
struct StateType {
  const char* name;
  const StateType* parent;  // nullptr for the top
  std::unique_ptr<StateBase> (*create)();
};

template <class State>
const StateType& state_type();

// Holds one object per state class, and moves between them.
class Engine {
 public:
  // The component, which may be null, is told of everything its listeners can hear.
  Engine(RTObject_impl* component, const StateType& top);
  ~Engine();
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  StateBase& current();
  const StateType& current_type() const { return *current_; }
  // Any thread.
  std::string current_name() const;
  // Takes effect in settle().
  void request(const StateType& target) { requested_ = &target; }
  // Makes the transitions that were asked for, and those that they ask for.
  void settle();
  // Leaves every state and starts again in the top.
  void restart();

  template <class Box>
  Box& box() {
    std::shared_ptr<void>& box = boxes_[typeid(Box)];
    if (!box) box = std::make_shared<Box>();
    return *static_cast<Box*>(box.get());
  }

  // The transition to the state whose last substate was left: itself when there was none.
  const StateType& history_of(const StateType& state) const;

  // Events that wait for their turn; from any thread.
  void push(std::function<void()> event);
  void run_events();

  void add_event_profile(const std::string& name, const std::string& data_type);

 private:
  StateBase& state(const StateType& type);
  void enter(const StateType& type);
  void leave(const StateType& type);
  void set_current(const StateType& type);

  RTObject_impl* const component_;
  const StateType& top_;
  const StateType* current_;
  const StateType* requested_ = nullptr;
  std::map<const StateType*, std::unique_ptr<StateBase>> states_;
  std::map<const StateType*, const StateType*> history_;
  std::map<std::type_index, std::shared_ptr<void>> boxes_;
  mutable std::mutex mutex_;  // for what other threads reach
  std::string current_name_;
  std::deque<std::function<void()>> events_;
  FsmStructure structure_;
  ExtendedFsmServiceProvider* service_ = nullptr;  // the component's
};

// Of the top: what states call.
template <class Top>
class TopBase : public StateBase {
 public:
  struct Box {};
  using TOP = Top;
  static constexpr const StateType* parent_type() { return nullptr; }

 protected:
  template <class State>
  void setState() {
    engine_->request(state_type<State>());
  }
  template <class State>
  void setStateHistory() {
    engine_->request(engine_->history_of(state_type<State>()));
  }
  template <class State>
  bool isCurrent() const {
    return &engine_->current_type() == &state_type<State>();
  }
};

template <class State, class Super>
class Link : public Super {
 public:
  using SUPER = Super;
  static const StateType* parent_type() { return &state_type<Super>(); }
  // Events are inherited from the state above, these are not: that one has its own turn.
  ReturnCode_t onInit() override { return RTC_OK; }
  ReturnCode_t onEntry() override { return RTC_OK; }
  ReturnCode_t onExit() override { return RTC_OK; }
};

template <class State>
const StateType& state_type() {
  static const StateType type{State::_state_name(), State::parent_type(), [] { return std::unique_ptr<StateBase>(new State()); }};
  return type;
}

}  // namespace fsm

template <class Top>
class Machine {
 public:
  using TOP = Top;

  explicit Machine(RTObject_impl* component = nullptr) : engine_(component, fsm::state_type<Top>()) { engine_.settle(); }

  // machine->event(args): the present state handles it; transitions follow when the expression ends.
  class Call {
   public:
    explicit Call(fsm::Engine& engine) : engine_(engine) {}
    ~Call() { engine_.settle(); }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;
    Top* operator->() { return static_cast<Top*>(&engine_.current()); }

   private:
    fsm::Engine& engine_;
  };
  Call operator->() { return Call(engine_); }

  template <class... Parameters, class... Arguments>
  void dispatch(void (Top::*handler)(Parameters...), Arguments... arguments) {
    (static_cast<Top&>(engine_.current()).*handler)(arguments...);
    engine_.settle();
  }

  // Queues an event, from any thread, for run_event().
  template <class... Parameters, class... Arguments>
  void push(void (Top::*handler)(Parameters...), Arguments... arguments) {
    engine_.push([this, handler, arguments...] { dispatch(handler, arguments...); });
  }
  void push(std::function<void()> event) { engine_.push(std::move(event)); }
  // Handles what has been queued until now.
  void run_event() { engine_.run_events(); }

  // Any thread.
  std::string current_state() const { return engine_.current_name(); }
  // What tools are told about an event of the machine.
  void add_event_profile(const std::string& name, const std::string& data_type) { engine_.add_event_profile(name, data_type); }
  void restart() { engine_.restart(); }

 private:
  fsm::Engine engine_;
};

}  // namespace RTC

#define FSM_TOP(TOP) struct TOP : public ::RTC::fsm::TopBase<TOP>
#define FSM_SUBSTATE(STATE, SUPER) struct STATE : public ::RTC::fsm::Link<STATE, SUPER>
// data(): the Box of the state, made with the first use; substates reach that of the top with TOP::data().
#define FSM_STATE(STATE)                                     \
 public:                                                     \
  Box& data() { return this->engine_->template box<Box>(); } \
  static const char* _state_name() { return #STATE; }        \
  using SELF = STATE

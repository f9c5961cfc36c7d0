// State machines written as classes: FSM_TOPSTATE is the machine with its events as virtual functions, FSM_SUBSTATE a state below another.
// A state handles an event by overriding its function; setState<Other>() takes effect when the handler returns. A machine belongs to one
// thread at a time (events may be queued from any); its state may be asked for from any thread.
//
//   FSM_TOPSTATE(Top) { FSM_STATE(Top); virtual void open() {} };
//   FSM_SUBSTATE(Closed, Top) { FSM_STATE(Closed); void open() override { setState<Opened>(); } };
//   RTC::Machine<Top> machine(component);  machine->open();
#pragma once

#include <rtm/RTObject.h>
#include <rtm/idl/ExtendedFsmServiceStub.h>

#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace RTC {

class ExtendedFsmServiceProvider;

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

// What a state remembers of the states below it: nothing, the one next to it, or the one that was current.
enum class History { none, shallow, deep };

// A state class as data; one object per class.
struct StateType {
  const char* name;
  const StateType* parent;  // nullptr for the top
  std::unique_ptr<StateBase> (*create)();
  History history;
  bool keeps_box;
};

// Of states that have no data of their own.
struct EmptyBox {};

// An event with its arguments.
template <class Top>
struct QueuedEvent {
  std::function<void(Top&)> call;
};
// dispatch(Event(&TOP::minute, time)): found by way of the state's base class.
template <class Top, class Result, class... Parameters, class... Arguments>
QueuedEvent<Top> Event(Result (Top::*handler)(Parameters...), Arguments... arguments) {
  return {[handler, arguments...](Top& state) { (state.*handler)(arguments...); }};
}

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
  // Takes effect in settle(). `init` is called instead of onInit.
  void request(const StateType& target, std::function<void(StateBase&)> init = nullptr);
  // Handed to the state that is current after the transitions.
  void dispatch(std::function<void(StateBase&)> event) { dispatched_.push_back(std::move(event)); }
  // Makes the transitions that were asked for, those that they ask for, and handles the events dispatched meanwhile.
  void settle();
  // Leaves every state and starts again in the top.
  void restart();

  // The data of a state, made with the first use; it goes when the state is left, unless it is PERSISTENT().
  template <class Box>
  Box& box(const StateType& state) {
    std::shared_ptr<void>& box = boxes_[&state];
    if (!box) box = std::make_shared<Box>();
    return *static_cast<Box*>(box.get());
  }
  // Takes effect when the state is entered.
  void give_box(const StateType& state, std::shared_ptr<void> box) { given_ = {&state, std::move(box)}; }

  // What the state remembers; itself when that is nothing.
  const StateType& history_of(const StateType& state) const;

  // Events that wait for their turn; from any thread.
  void push(std::function<void()> event);
  void run_events();

  void add_event_profile(const std::string& name, const std::string& data_type);

 private:
  StateBase& state(const StateType& type);
  void transit(const StateType& target, const std::function<void(StateBase&)>& init);
  void enter(const StateType& type);
  void leave(const StateType& type);
  void set_current(const StateType& type);

  RTObject_impl* const component_;
  const StateType& top_;
  const StateType* current_;
  const StateType* requested_ = nullptr;
  std::function<void(StateBase&)> requested_init_;
  std::deque<std::function<void(StateBase&)>> dispatched_;
  std::pair<const StateType*, std::shared_ptr<void>> given_;
  std::map<const StateType*, std::unique_ptr<StateBase>> states_;
  std::map<const StateType*, const StateType*> history_;
  std::map<const StateType*, std::shared_ptr<void>> boxes_;
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
  using Box = EmptyBox;
  using TOP = Top;
  using SUPER = TopBase;
  static constexpr const StateType* parent_type() { return nullptr; }
  static constexpr History history_kind() { return History::none; }
  static constexpr bool keeps_box() { return false; }

 protected:
  // With arguments the target's init(arguments...) is called instead of onInit(); a pointer to its Box becomes its data and the target's.
  template <class State, class... Arguments>
  void setState(Arguments... arguments) {
    if constexpr (sizeof...(Arguments) == 0) {
      engine_->request(state_type<State>());
    } else if constexpr ((std::is_same_v<Arguments, typename State::Box*> && ...)) {
      (engine_->give_box(state_type<State>(), std::shared_ptr<typename State::Box>(arguments)), ...);
      engine_->request(state_type<State>());
    } else {
      engine_->request(state_type<State>(), [arguments...](StateBase& state) { static_cast<State&>(state).init(arguments...); });
    }
  }
  template <class State>
  void setStateHistory() {
    engine_->request(engine_->history_of(state_type<State>()));
  }
  // The event is handled by the state that is current after the handler and its transitions.
  void dispatch(QueuedEvent<Top> event) {
    engine_->dispatch([event = std::move(event)](StateBase& state) { event.call(static_cast<Top&>(state)); });
  }
  template <class State>
  bool isCurrent() const {
    return &engine_->current_type() == &state_type<State>();
  }
};

template <class State, class Super>
class Link : public Super {
 public:
  using Box = EmptyBox;
  using SUPER = Super;
  static const StateType* parent_type() { return &state_type<Super>(); }
  static constexpr History history_kind() { return History::none; }
  static constexpr bool keeps_box() { return false; }
  // Events are inherited from the state above, these are not: that one has its own turn.
  ReturnCode_t onInit() override { return RTC_OK; }
  ReturnCode_t onEntry() override { return RTC_OK; }
  ReturnCode_t onExit() override { return RTC_OK; }
};

template <class State>
const StateType& state_type() {
  static const StateType type{State::_state_name(), State::parent_type(), [] { return std::unique_ptr<StateBase>(new State()); },
                              State::history_kind(), State::keeps_box()};
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
    // What a handler threw goes on; transitions that it asked for follow with the next event.
    ~Call() noexcept(false) {
      if (std::uncaught_exceptions() == exceptions_) engine_.settle();
    }
    Call(const Call&) = delete;
    Call& operator=(const Call&) = delete;
    Top* operator->() { return static_cast<Top*>(&engine_.current()); }

   private:
    fsm::Engine& engine_;
    const int exceptions_ = std::uncaught_exceptions();
  };
  Call operator->() { return Call(engine_); }

  template <class Result, class... Parameters, class... Arguments>
  void dispatch(Result (Top::*handler)(Parameters...), Arguments... arguments) {
    dispatch(fsm::Event(handler, arguments...));
  }
  void dispatch(const fsm::QueuedEvent<Top>& event) {
    event.call(static_cast<Top&>(engine_.current()));
    engine_.settle();
  }

  // Queues an event, from any thread, for run_event().
  template <class Result, class... Parameters, class... Arguments>
  void push(Result (Top::*handler)(Parameters...), Arguments... arguments) {
    engine_.push([this, event = fsm::Event(handler, arguments...)] { dispatch(event); });
  }
  void push(std::function<void()> event) { engine_.push(std::move(event)); }
  // Handles what has been queued until now.
  void run_event() { engine_.run_events(); }

  // Any thread.
  std::string current_state() const { return engine_.current_name(); }
  // machine.currentState().name()
  struct StateName {
    std::string text;
    const char* name() const { return text.c_str(); }
  };
  StateName currentState() const { return {engine_.current_name()}; }
  // The data of the top.
  typename Top::Box& box() { return engine_.template box<typename Top::Box>(fsm::state_type<Top>()); }
  // What tools are told about an event of the machine.
  void add_event_profile(const std::string& name, const std::string& data_type) { engine_.add_event_profile(name, data_type); }
  void restart() { engine_.restart(); }

 private:
  fsm::Engine engine_;
};

}  // namespace RTC

#define FSM_TOPSTATE(TOP) struct TOP : public ::RTC::fsm::TopBase<TOP>
#define FSM_SUBSTATE(STATE, SUPER) struct STATE : public ::RTC::fsm::Link<STATE, SUPER>
// After the state's `struct Box`, if it has one. box(): the data of the state; states below reach that of the top with TOP::box().
#define FSM_STATE(STATE)                                                                   \
 public:                                                                                   \
  Box& box() { return this->engine_->template box<Box>(::RTC::fsm::state_type<STATE>()); } \
  static const char* _state_name() { return #STATE; }                                      \
  using SELF = STATE
// setStateHistory<State>() goes to the state below it that was current when it was left (deep), or to the one next to it on the way there.
#define DEEPHISTORY() \
 public:              \
  static constexpr ::RTC::fsm::History history_kind() { return ::RTC::fsm::History::deep; }
#define HISTORY() \
 public:          \
  static constexpr ::RTC::fsm::History history_kind() { return ::RTC::fsm::History::shallow; }
// The data of the state outlives the state.
#define PERSISTENT() \
 public:             \
  static constexpr bool keeps_box() { return true; }
// Sources of 2.x give each state its number with this; states need none here.
#define FSM_INIT_VALUE(STATE) static_assert(sizeof(STATE) > 0, "FSM_INIT_VALUE comes after the definition of " #STATE);

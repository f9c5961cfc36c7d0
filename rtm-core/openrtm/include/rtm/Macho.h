// State machines as classes, under the names of the Macho library, on the machines of rtm/StaticFSM.h: for sources that include Macho
// themselves. States have entry(), exit() and init() without a result; what tools see of a machine, and events from ports, are StaticFSM's.
// One thread at a time.
#pragma once

#include <rtm/StaticFSM.h>

namespace Macho {

using RTC::fsm::Event;

template <class Top>
using IEvent = RTC::fsm::QueuedEvent<Top>;

template <class Top>
class TopBase : public RTC::fsm::TopBase<Top> {
 public:
  virtual void entry() {}
  virtual void exit() {}
  virtual void init() {}

 private:
  RTC::ReturnCode_t onEntry() override { return entry(), RTC::RTC_OK; }
  RTC::ReturnCode_t onExit() override { return exit(), RTC::RTC_OK; }
  RTC::ReturnCode_t onInit() override { return init(), RTC::RTC_OK; }
};

// A state does not inherit what the state above it does when it is entered or left.
template <class State, class Super>
class Link : public RTC::fsm::Link<State, Super> {
 public:
  void entry() override {}
  void exit() override {}
  void init() override {}

 private:
  RTC::ReturnCode_t onEntry() override { return entry(), RTC::RTC_OK; }
  RTC::ReturnCode_t onExit() override { return exit(), RTC::RTC_OK; }
  RTC::ReturnCode_t onInit() override { return init(), RTC::RTC_OK; }
};

// The machine of a top state, without a component.
template <class Top>
class Machine : public RTC::Machine<Top> {
 public:
  Machine() = default;
};

}  // namespace Macho

#define TOPSTATE(TOP) struct TOP : public ::Macho::TopBase<TOP>
#define SUBSTATE(STATE, SUPER) struct STATE : public ::Macho::Link<STATE, SUPER>
// After the state's `struct Box`, if it has one.
#define STATE(STATE) FSM_STATE(STATE)

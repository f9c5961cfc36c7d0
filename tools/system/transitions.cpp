#include "system/transitions.h"

#include <algorithm>
#include <thread>

namespace tools {
namespace {

// A context answers RTC_ERROR when the component's callback has not returned within a time of its own; it may still come.
constexpr std::chrono::milliseconds late_limit{6'000};

struct Wording {
  const char* verb;
  RTC::LifeCycleState from;
  RTC::LifeCycleState to;
};

Wording wording(Transition transition) {
  switch (transition) {
    case Transition::activate:
      return {"activating", RTC::INACTIVE_STATE, RTC::ACTIVE_STATE};
    case Transition::deactivate:
      return {"deactivating", RTC::ACTIVE_STATE, RTC::INACTIVE_STATE};
    case Transition::reset:
      break;
  }
  return {"resetting", RTC::ERROR_STATE, RTC::INACTIVE_STATE};
}

RTC::ReturnCode_t call(RTC::ExecutionContext_ptr context, RTC::RTObject_ptr component, Transition transition) {
  switch (transition) {
    case Transition::activate:
      return context->activate_component(component);
    case Transition::deactivate:
      return context->deactivate_component(component);
    case Transition::reset:
      break;
  }
  return context->reset_component(component);
}

Result<const ContextView*> pick_context(const ComponentView& component, int index) {
  if (component.contexts.empty()) return Error{"component " + component.path + ": participates in no execution context"};
  if (index < 0) return component.shown_context();
  if (static_cast<std::size_t>(index) >= component.contexts.size()) {
    return Error{"component " + component.path + ": has no execution context number " + std::to_string(index) + ", it has " +
                 std::to_string(component.contexts.size())};
  }
  return &component.contexts[static_cast<std::size_t>(index)];
}

}  // namespace

Result<void> change_state(const ComponentView& component, Transition transition, int index, std::chrono::milliseconds timeout) {
  const auto context = pick_context(component, index);
  if (!context) return context.error();
  const auto words = wording(transition);
  const auto what = std::string(words.verb) + " " + component.path;
  const auto state = (*context)->state;
  if (state == words.to && transition != Transition::reset) return {};
  if (state != words.from) {
    return Error{what + ": is " + state_text(state) + ", must be " + state_text(words.from) +
                 (state == RTC::ERROR_STATE ? " (try: rtse reset)" : "")};
  }
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  const CallLimit limited(std::max(default_transition_timeout, timeout));
  const auto called = remote(what + ":", [&] { code = call((*context)->object, component.object, transition); });
  if (!called) return called.error();
  if (code == RTC::RTC_OK) return {};
  RTC::LifeCycleState now = words.from;
  const auto late = timeout > default_transition_timeout ? timeout : late_limit;
  const auto end = std::chrono::steady_clock::now() + (code == RTC::RTC_ERROR ? late : std::chrono::milliseconds(0));
  while (true) {
    const auto asked = remote(what, [&] { now = (*context)->object->get_component_state(component.object); });
    if (!asked) return check(what, code);
    if (now == words.to) return {};  // late, but it arrived
    if (now != words.from || std::chrono::steady_clock::now() >= end) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // nobody tells when the callback returns
  }
  return check(what, code, "it is " + state_text(now) + " now, its log says why");
}

}  // namespace tools

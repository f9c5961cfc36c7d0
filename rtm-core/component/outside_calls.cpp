#include "component/outside_calls.h"

#include <utility>

namespace RTC {

namespace {

thread_local const RTObject_impl* called_from_outside = nullptr;

}  // namespace

bool is_watched_operation(std::string_view name) {
  return name.starts_with("on_") || name == "initialize" || name == "finalize" || name == "exit" || name == "attach_context" ||
         name == "detach_context";
}

OutsideCall::OutsideCall(const RTObject_impl& component) : before_(std::exchange(called_from_outside, &component)) {}
OutsideCall::~OutsideCall() { called_from_outside = before_; }

bool OutsideCall::is_mine(const RTObject_impl& component) {
  if (called_from_outside != &component) return false;
  called_from_outside = nullptr;
  return true;
}

std::optional<std::string> why_not(rt::Action action, std::optional<bool> active) {
  if (!active) return "the handle belongs to no execution context of another process in which the component participates";
  switch (action) {
    case rt::Action::activated:
    case rt::Action::error:
      if (*active) return "the component is active in that execution context";
      break;
    case rt::Action::execute:
    case rt::Action::state_update:
    case rt::Action::deactivated:
      if (!*active) return "the component is not active in that execution context";
      break;
    case rt::Action::startup:
    case rt::Action::shutdown:
    case rt::Action::rate_changed:
    case rt::Action::aborting:
    case rt::Action::reset:
      break;
  }
  return std::nullopt;
}

bool is_active_after(rt::Action action, bool active) {
  switch (action) {
    case rt::Action::activated:
      return true;
    case rt::Action::deactivated:
    case rt::Action::aborting:
    case rt::Action::reset:
      return false;
    default:
      return active;
  }
}

}  // namespace RTC

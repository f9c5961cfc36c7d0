#include "core/lifecycle.h"

namespace rt {

std::string_view to_text(State state) {
  switch (state) {
    case State::created:
      return "created";
    case State::inactive:
      return "inactive";
    case State::active:
      return "active";
    case State::error:
      return "error";
  }
  return "unknown state";
}

std::string_view to_text(Event event) {
  switch (event) {
    case Event::activate:
      return "activate";
    case Event::deactivate:
      return "deactivate";
    case Event::reset:
      return "reset";
    case Event::fail:
      return "fail";
  }
  return "unknown event";
}

std::string_view to_text(Action action) {
  switch (action) {
    case Action::startup:
      return "on_startup";
    case Action::shutdown:
      return "on_shutdown";
    case Action::activated:
      return "on_activated";
    case Action::deactivated:
      return "on_deactivated";
    case Action::aborting:
      return "on_aborting";
    case Action::error:
      return "on_error";
    case Action::reset:
      return "on_reset";
    case Action::execute:
      return "on_execute";
    case Action::state_update:
      return "on_state_update";
    case Action::rate_changed:
      return "on_rate_changed";
  }
  return "unknown action";
}

std::string_view callback_of(Action action) {
  switch (action) {
    case Action::startup:
      return "onStartup";
    case Action::shutdown:
      return "onShutdown";
    case Action::activated:
      return "onActivated";
    case Action::deactivated:
      return "onDeactivated";
    case Action::aborting:
      return "onAborting";
    case Action::error:
      return "onError";
    case Action::reset:
      return "onReset";
    case Action::execute:
      return "onExecute";
    case Action::state_update:
      return "onStateUpdate";
    case Action::rate_changed:
      return "onRateChanged";
  }
  return "unknown callback";
}

}  // namespace rt

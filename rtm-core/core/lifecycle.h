// The life cycle of a component in one execution context as a table: states, events, transitions and callbacks. Values; any
// thread. Source: OMG Robotic Technology Component 1.1, 5.2.2; the order of actions after a failure is that of OpenRTM-
// aist.
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace rt {

// With the numbers of the wire.
enum class State { created = 0, inactive = 1, active = 2, error = 3 };

// `fail` is what the context itself decides when an action of an active component fails.
enum class Event { activate, deactivate, reset, fail };

enum class Action { startup, shutdown, activated, deactivated, aborting, error, reset, execute, state_update, rate_changed };

struct Transition {
  State from;
  Event event;
  State to;
  std::optional<Action> leave;  // called before the state changes
  State if_leave_fails;         // where it goes then, with that state's entry action unless it is `from`
};

inline constexpr std::array transitions{
    Transition{State::inactive, Event::activate, State::active, std::nullopt, State::error},
    Transition{State::active, Event::deactivate, State::inactive, Action::deactivated, State::error},
    Transition{State::active, Event::fail, State::error, Action::deactivated, State::error},
    Transition{State::error, Event::reset, State::inactive, Action::reset, State::error},
};

struct StateActions {
  State state;
  std::optional<Action> enter;         // when it fails in `active`, the component fails in the next cycle
  std::optional<Action> execute;       // second stage of each cycle
  std::optional<Action> state_update;  // third stage, unless the second has failed
};

inline constexpr std::array state_actions{
    StateActions{State::created, std::nullopt, std::nullopt, std::nullopt},
    StateActions{State::inactive, std::nullopt, std::nullopt, std::nullopt},
    StateActions{State::active, Action::activated, Action::execute, Action::state_update},
    StateActions{State::error, Action::aborting, Action::error, std::nullopt},
};

// nullptr when the event is not possible in that state.
constexpr const Transition* find_transition(State from, Event event) {
  for (const Transition& transition : transitions)
    if (transition.from == from && transition.event == event) return &transition;
  return nullptr;
}

constexpr const StateActions& actions_of(State state) { return state_actions[static_cast<std::size_t>(state)]; }

std::string_view to_text(State state);
std::string_view to_text(Event event);
// "on_activated", ...
std::string_view to_text(Action action);
// "onActivated", ...: the name that authors know.
std::string_view callback_of(Action action);

}  // namespace rt

// State transitions of a component in one of its execution contexts. One thread at a time.
#pragma once

#include <chrono>

#include "system/component_view.h"

namespace tools {

enum class Transition { activate, deactivate, reset };

// A transition lasts as long as the component's own callback; other tools wait half a second and then report a failure.
constexpr std::chrono::milliseconds default_transition_timeout{10'000};

// Returns when the component has arrived, or fails. A component that is in the wanted state already is not an error, but for a reset.
// `context` is an index into the component's contexts; -1: the first that runs. `timeout` below the default counts as the default.
Result<void> change_state(const ComponentView& component, Transition transition, int context,
                          std::chrono::milliseconds timeout = default_transition_timeout);

}  // namespace tools

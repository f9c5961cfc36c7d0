// Requests transitions of a component in one of its contexts, for all commands that do so. One thread at a time.
#pragma once

#include <chrono>

#include "system/component_view.h"

namespace editor {

enum class Transition { activate, deactivate, reset };

// At least so long is waited for each from now on; a callback may be slow where time waits for it.
void wait_for_states(std::chrono::milliseconds time);

// Returns when the component has arrived, or fails. `context` is an index into the component's contexts; -1: the first.
Result<void> change_state(const ComponentView& component, Transition transition, int context);

}  // namespace editor

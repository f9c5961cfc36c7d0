// Finds the time and the object of an expectation that was not met. Pure; any thread.
#pragma once

#include <optional>
#include <string>

#include "run/expectations.h"

namespace tools {

// [simulated s] Nothing: at the end of the run, or the time is not known.
std::optional<double> failure_time(const Expectation& expectation, const Seen& seen);
// The name of the model or of the component that it is about; empty for a command.
std::string failed_object(const Expectation& expectation);

}  // namespace tools

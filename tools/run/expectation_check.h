// Checks that the names in expectations exist, so that a misspelt name is found before the run and not after it. Each error begins with the
// expectation, and says what there is instead. One thread at a time.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "run/expectations.h"
#include "system/profile/rts_profile.h"
#include "system/session.h"

namespace tools {

// Components, of states and of ports.
base::Result<void> check_components(const std::vector<Expectation>& expectations, const SavedSystem& system);
// `models`: all of the world, before the first step.
base::Result<void> check_models(const std::vector<Expectation>& expectations, const std::vector<std::string>& models);
// Joints and grippers, likewise.
base::Result<void> check_parts(const std::vector<Expectation>& expectations, const std::vector<ModelParts>& parts);
// Of an expectation of a value: that the port exists, sends a known data type, and that this has the member as a number. Asks the
// component. One with an empty member is about all numbers.
base::Result<void> check_value(const Session& session, const Expectation& expectation);
// All of them.
base::Result<void> check_values(const Session& session, const std::vector<Expectation>& expectations);

}  // namespace tools

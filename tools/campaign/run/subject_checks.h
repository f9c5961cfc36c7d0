// Checks that the models, components and ports that a plan measures and expects exist. Any thread.
#pragma once

#include <map>
#include <string>

#include "campaign/plan/plan.h"
#include "campaign/rows/world_file.h"
#include "system/profile/rts_profile.h"

namespace campaign {

// A port is there when the profile lists it, or lists none of its component. What is spawned may have any name.
Result<void> check_subjects(const Plan& plan, const editor::SavedSystem& system, const std::map<std::string, StandingModel>& models);
// That of a condition or a measure, COMPONENT:PORT; empty: good. The problem says what is there.
std::string port_problem(const editor::SavedSystem& system, const std::string& port);
// Of a number that it sends, as far as the profile's connections tell; empty: good.
std::string value_problem(const editor::SavedSystem& system, const std::string& port, const std::string& member);

}  // namespace campaign

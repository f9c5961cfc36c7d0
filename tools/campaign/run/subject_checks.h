// Checks that what a plan or hunt measures, expects and changes exists: components, parameters, connections, ports, models and ifaces.
// Errors are reported before the first run, since every row would fail. Any thread.
#pragma once

#include <map>
#include <string>

#include "campaign/plan/plan.h"
#include "campaign/rows/world_file.h"
#include "system/profile/rts_profile.h"

namespace campaign {

// A port is there when the profile lists it, or lists none of its component. What is spawned may have any name.
Result<void> check_subjects(const Plan& plan, const tools::SavedSystem& system, const std::map<std::string, SurveyedModel>& models);

}  // namespace campaign

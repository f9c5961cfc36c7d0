// Checks that the actions of a plan or hunt refer to existing components, parameters, connections, models and ifaces. Errors are reported
// before the first run, since every row would fail. Any thread.
#pragma once

#include <map>
#include <string>

#include "campaign/plan/plan.h"
#include "campaign/rows/world_file.h"
#include "system/profile/rts_profile.h"

namespace campaign {

// The error names what was asked for, and what there is. Models that an event spawns count as there.
Result<void> check_deeds(const Plan& plan, const editor::SavedSystem& system, const std::map<std::string, StandingModel>& models);

}  // namespace campaign

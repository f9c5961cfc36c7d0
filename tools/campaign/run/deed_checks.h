// Whether what a plan does to its runs, or lets a hunt do, speaks of things that are there: components, parameters, connections, models,
// ifaces. Said before the first run, else every row would fail with it. Any thread.
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

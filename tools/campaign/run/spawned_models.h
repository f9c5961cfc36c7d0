// The files of the models that events of a plan spawn. Any thread.
#pragma once

#include <set>
#include <string>

#include "campaign/plan/plan.h"

namespace campaign {

// Sets the events' relative paths to whole ones: of the plan's folder, else of the one that rtse is called in. Returns all files that the
// models are made of; an error for a model that nobody finds.
Result<std::set<std::string>> find_spawned(Plan& plan);

}  // namespace campaign

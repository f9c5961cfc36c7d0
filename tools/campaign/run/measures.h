// Computes the measures of a plan from a finished run. Any thread.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "campaign/plan/plan.h"
#include "campaign/rows/world_file.h"
#include "run/run_system.h"

namespace campaign {

// What port values, joints and grips the measures need to be seen, as expectations without limits.
std::vector<tools::Expectation> watched_values(const std::vector<Measure>& measures);

// By name; what a run does not have (a goal that was not reached) is missing. `models`: of the run's world.
std::map<std::string, double> take_measures(const std::vector<Measure>& measures, const tools::Seen& seen,
                                            const std::map<std::string, SurveyedModel>& models, double wall_s);

}  // namespace campaign

// Reports two hash logs to people: the first difference with its values. One thread at a time.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "base/hash_log.h"

namespace tools {

// Empty when the runs are the same; else one line: when, where, and both values.
std::string difference_text(const base::HashComparison& comparison);
nlohmann::ordered_json difference_json(const base::HashComparison& comparison);

}  // namespace tools

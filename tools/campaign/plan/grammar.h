// The grammar of plans as tables. The reader checks files against it, and the published JSON Schema is generated from it. Values; any
// thread.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string_view>

#include "run/yaml_shape.h"

namespace campaign {

inline constexpr std::string_view plan_shape = "plan";

// All that a plan can have; plan_shape: itself.
tools::Shapes plan_shapes();

// Draft 2020-12.
nlohmann::ordered_json plan_schema();

}  // namespace campaign

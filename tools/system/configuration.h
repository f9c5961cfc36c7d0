// Configuration sets of a component: reads, checks and changes them. One thread at a time.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "system/component_view.h"

namespace tools {

// Null: the component has no such set.
const ConfigurationSetView* find_set(const ComponentView& component, const std::string& id);

// Whether the component declares a type for this parameter.
bool has_type(const ComponentView& component, const std::string& parameter);
// "" or what a value of this parameter must be, by the type and the constraint that the component declares.
std::string value_problem(const ComponentView& component, const std::string& parameter, const std::string& value);

// Merges the values into the set; it is applied when the set is activated.
Result<void> set_values(const ComponentView& component, const std::string& id,
                        const std::vector<std::pair<std::string, std::string>>& values);
Result<void> use_set(const ComponentView& component, const std::string& id);

}  // namespace tools

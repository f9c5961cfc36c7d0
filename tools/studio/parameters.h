// Configuration parameters of components as parameters of foxglove.websocket.v1: those of the active sets, named INSTANCE.PARAMETER.
// Reading and writing call components, each with the timeout of `context`: on workers only. `system` is the event of that name.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "studio/acts.h"

namespace studio {

using Parameters = std::map<std::string, Json>;  // numbers, texts

// Of these names, or all when there are none. Names that do not exist, and components that do not respond, are left out.
Parameters read_parameters(const ActContext& context, const Json& system, const std::vector<std::string>& names);
// Sets each; an error names those that could not be set.
base::Result<void> write_parameters(const ActContext& context, const Json& system, const std::vector<std::pair<std::string, Json>>& values);

std::string parameter_values(const Parameters& parameters, const std::optional<std::string>& id);

// A value with this type in `__type__` as viewers see it, and back to text. Fails for objects and null.
Json value_from_text(const std::string& text, const std::string& type);
base::Result<std::string> text_from_value(const std::string& name, const Json& value);

}  // namespace studio

// Converts a running system to the JSON of the page (docs/develop/studio-protocol.md). Pure; any thread.
#pragma once

#include <vector>

#include "studio/client_message.h"
#include "system/component_view.h"

namespace studio {

// Everything that a diagram shows.
Json components_json(const std::vector<editor::ComponentView>& components);
// Each once, however many ports tell of it. Ends outside of `components` are said in words.
Json connections_json(const std::vector<editor::ComponentView>& components);
Json managers_json(const editor::NamingTree& tree);
// One component with its properties and configuration.
Json details_json(const editor::ComponentView& component);

}  // namespace studio

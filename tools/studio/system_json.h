// Converts a running system to the JSON of the page (docs/develop/studio-protocol.md). Pure; any thread.
#pragma once

#include <vector>

#include "studio/client_message.h"
#include "system/component_view.h"

namespace studio {

// Everything that a diagram shows.
Json components_json(const std::vector<tools::ComponentView>& components);
// Each once, however many ports tell of it. Ends outside of `components` are said in words.
Json connections_json(const std::vector<tools::ComponentView>& components);
Json managers_json(const tools::NamingTree& tree);
// One component with its properties and configuration.
Json details_json(const tools::ComponentView& component);

}  // namespace studio

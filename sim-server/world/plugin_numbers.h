// Numbers in the parameters of plugins that drive or push: each has one line when it is impossible (a word, empty text, a negative speed
// limit). It is removed from the parameters then, so that every reader takes its default. One table says which element must hold what; what
// a plugin's own reader rejects with a line (a wheel radius of 0) is only read as a number here. Errors: none, findings only. Values in the
// units of the plugins. One thread at a time, as Complaints.
#pragma once

#include <pugixml.hpp>

#include "world/complaints.h"
#include "world/plugin_kind.h"

namespace sim {

// `plugin` was read from `node`. Does nothing for plugins of other kinds, except to name what is nan.
void check_numbers(pugi::xml_node node, PluginDef& plugin, Complaints& complaints);

}  // namespace sim

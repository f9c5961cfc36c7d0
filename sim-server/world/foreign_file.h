// Worlds of simulators that came before Gazebo, recognised by their text. Pure; any thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace sim {

// For a world file of Stage or a configuration file of Player: what it is and what to do, in words that follow "FILE: ". Empty for all
// others.
std::optional<std::string> foreign_file(std::string_view text);

}  // namespace sim

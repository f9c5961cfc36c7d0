// Command lines that the page shows where nothing runs yet. They work as they are in the folder in which rtm-studio was started: programs,
// modules and the world are named by paths that exist there, of a build tree or of an installation. Pure but for looking at files; any
// thread.
#pragma once

#include <cstdint>
#include <string>

namespace studio {

struct StartHints {
  std::string simulator;   // starts a simulator with this ID
  std::string components;  // starts a name server and components
};
StartHints start_hints(std::uint32_t server_id, const std::string& name_server);

// The first world to show: the obstacle course in this folder, of the installation or of the build tree. Empty: it is nowhere.
std::string usual_world();
// The folder of the modules of components that belong to this program.
std::string own_modules();

}  // namespace studio

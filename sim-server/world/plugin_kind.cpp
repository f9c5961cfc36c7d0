#include "world/plugin_kind.h"

#include <algorithm>
#include <map>

#include "base/text.h"

namespace sim {

namespace {

// "libgazebo_ros_diff_drive.so" -> "diffdrive", "ignition-gazebo6-diff-drive-system" -> "diffdrive", "gz::sim::systems::DiffDrive" ->
// "diffdrive".
std::string core_of(std::string_view text) {
  std::string name = base::to_lower(text);
  if (const std::size_t slash = name.rfind('/'); slash != std::string::npos) name.erase(0, slash + 1);
  if (const std::size_t scope = name.rfind("::"); scope != std::string::npos) name.erase(0, scope + 2);
  if (const std::size_t dot = name.find(".so"); dot != std::string::npos) name.erase(dot);
  if (const std::size_t dot = name.find(".dll"); dot != std::string::npos) name.erase(dot);
  name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c == '_' || c == '-' || c == ' ' || (c >= '0' && c <= '9'); }),
             name.end());
  for (std::string_view prefix : {"lib", "ignition", "gazeboros", "gazebo", "gzsim", "gz", "sim"}) {
    if (name.starts_with(prefix) && name.size() > prefix.size() + 2) name.erase(0, prefix.size());
  }
  for (std::string_view suffix : {"system", "plugin"}) {
    if (name.ends_with(suffix) && name.size() > suffix.size()) name.erase(name.size() - suffix.size());
  }
  return name;
}

const std::map<std::string_view, PluginKind>& table() {
  using enum PluginKind;
  static const std::map<std::string_view, PluginKind> known{
      {"diffdrive", differential_drive},
      {"differentialdrive", differential_drive},
      {"rtmsimdiffdrive", differential_drive},
      {"skidsteerdrive", skid_steer_drive},
      {"skidsteer", skid_steer_drive},
      {"velocitycontrol", velocity_control},
      {"planarmove", velocity_control},
      {"trajectoryfollower", trajectory_follower},
      {"ackermannsteering", unsupported_drive},
      {"ackermanndrive", unsupported_drive},
      {"mecanumdrive", unsupported_drive},
      {"tricycledrive", unsupported_drive},
      {"omniwheeldrive", unsupported_drive},
      {"trackedvehicle", unsupported_drive},
      {"trackcontroller", unsupported_drive},
      {"simpletrackedvehicle", unsupported_drive},
      {"kinematicskidsteerdrive", unsupported_drive},
      {"multicopter", unsupported_drive},
      {"multicoptermotormodel", unsupported_drive},
      {"multicoptervelocitycontrol", unsupported_drive},
      {"liftdrag", unsupported_drive},
      {"hydrodynamics", unsupported_drive},
      {"thruster", unsupported_drive},
      {"vehicle", unsupported_drive},
      {"cartdemo", unsupported_drive},
      // Done by the simulator anyway.
      {"physics", implied},
      {"sensors", implied},
      {"scenebroadcaster", implied},
      {"usercommands", implied},
      {"contact", implied},
      {"windeffects", implied},
      {"wind", implied},
      {"ftsensor", implied},
      {"imu", implied},
      {"imusensor", implied},
      {"navsat", implied},
      {"altimeter", implied},
      {"magnetometer", implied},
      {"airpressure", implied},
      {"forcetorque", implied},
      {"posepublisher", implied},
      {"jointstatepublisher", implied},
      {"odometrypublisher", implied},
      {"laser", implied},
      {"laserscan", implied},
      {"gpulaser", implied},
      {"raysensor", implied},
      {"camera", implied},
      {"depthcamera", implied},
      {"opennikinect", implied},
      {"multicamera", implied},
      {"bumper", implied},
      {"range", implied},
      {"gps", implied},
      {"gpssensor", implied},
      {"p", implied},
      {"pd", implied},
      {"state", implied},
      {"init", implied},
      {"factory", implied},
      {"apirosapi", implied},
      {"rosapi", implied},
      {"rosapiplugin", implied},
      {"labels", implied},
      {"scene", implied},
      {"scenemanager", implied},
      {"minimalscene", implied},
      {"worldstats", implied},
      {"worldcontrol", implied},
      {"statictransformpublisher", implied},
  };
  return known;
}

}  // namespace

PluginKind kind_of_plugin(std::string_view filename, std::string_view name) {
  if (const auto found = table().find(core_of(filename)); found != table().end()) return found->second;
  // The name is the user's own word in Gazebo classic, so that only class names count.
  if (name.find("::") == std::string_view::npos) return PluginKind::unknown;
  const auto found = table().find(core_of(name));
  return found == table().end() ? PluginKind::unknown : found->second;
}

std::string iface_own_name(const PluginDef& plugin) {
  return plugin.name.empty() || plugin.name.find("::") != std::string::npos ? "position2d" : plugin.name;
}

PluginKind kind_of(const PluginDef& plugin) { return kind_of_plugin(plugin.filename, plugin.name); }

}  // namespace sim

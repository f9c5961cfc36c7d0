#include "world/plugin_kind.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "base/text.h"

namespace sim {

namespace {

const std::map<std::string_view, PluginKind>& table() {
  using enum PluginKind;
  static const std::map<std::string_view, PluginKind> known{
      {"diffdrive", differential_drive},
      {"differentialdrive", differential_drive},
      {"rtmsimdiffdrive", differential_drive},
      {"skidsteerdrive", skid_steer_drive},
      {"skidsteer", skid_steer_drive},
      {"ackermannsteering", car_drive},
      {"ackermanndrive", car_drive},
      {"velocitycontrol", velocity_control},
      {"planarmove", velocity_control},
      {"trajectoryfollower", trajectory_follower},
      {"buoyancy", buoyancy},
      {"linearbattery", battery},
      {"battery", battery},
      {"hydrodynamics", hydrodynamics},
      {"liftdrag", lift_drag},
      {"advancedliftdrag", advanced_lift_drag},
      {"lighterthanairdynamics", lighter_than_air},
      {"buoyancyengine", buoyancy_engine},
      {"surface", floating_hull},
      {"simplehydrodynamics", hydrodynamics},
      {"thruster", thruster},
      {"multicopter", unsupported_drive},
      {"multicoptermotormodel", rotor},
      {"motormodel", rotor},
      {"rotorsgazebomotormodel", rotor},
      {"multicoptervelocitycontrol", multicopter_control},
      {"multicoptercontrol", multicopter_control},
      {"applyjointforce", joint_force},
      {"applylinkwrench", link_wrench},
      {"windeffects", wind_effects},
      {"jointpositioncontroller", joint_controller},
      {"jointcontroller", joint_controller},
      {"jointtrajectorycontroller", joint_controller},
      {"gazeboroscontrol", joint_controller},
      {"roscontrol", joint_controller},
      {"ignroscontrol", joint_controller},
      {"detachablejoint", detachable_joint},
      {"mecanumdrive", mecanum_drive},
      {"omnidrive", omni_drive},
      {"rtmsimomnidrive", omni_drive},
      {"omniwheeldrive", omni_drive},
      {"omnidirectionaldrive", omni_drive},
      {"tricycledrive", tricycle_drive},
      {"trackedvehicle", tracked_vehicle},
      {"simpletrackedvehicle", tracked_vehicle},
      {"trackcontroller", track_controller},
      {"wheelslip", wheel_slip},
      {"odometrypublisher", odometry_publisher},
      {"jointstatepublisher", joint_state_publisher},
      {"kinematicskidsteerdrive", unsupported_drive},
      {"vehicle", unsupported_drive},
      {"cartdemo", unsupported_drive},
      {"label", label},
      {"thermal", thermal},
      {"thermalsensor", thermal_sensor},
      {"fiducial", fiducial},
      {"rtmsimfiducial", fiducial},
      // Done by the simulator anyway.
      {"physics", implied},
      {"sensors", implied},
      {"scenebroadcaster", implied},
      {"usercommands", implied},
      {"contact", implied},
      {"wind", implied},
      {"ftsensor", implied},
      {"imu", implied},
      {"imusensor", implied},
      {"hectorgazeborosimu", implied},
      {"navsat", implied},
      {"altimeter", implied},
      {"magnetometer", implied},
      {"airpressure", implied},
      {"airspeed", implied},
      {"dopplervelocitylog", implied},
      {"dvl", implied},
      {"rfidsensor", implied},
      {"logicalcamera", implied},
      {"forcetorque", implied},
      {"posepublisher", implied},
      {"graspfix", implied},
      {"mimicjoint", implied},
      {"roboticsgroupgazebomimicjoint", implied},
      {"roboticsgroupupatrasgazebomimicjoint", implied},
      {"laser", implied},
      {"laserscan", implied},
      {"gpulaser", implied},
      {"raysensor", implied},
      {"ray", implied},
      {"gpuray", implied},
      {"blocklaser", implied},
      {"velodynelaser", implied},
      {"velodynegpulaser", implied},
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

// "libgazebo_ros_diff_drive.so", "ignition-gazebo6-diff-drive-system" and "gz::sim::systems::DiffDrive" are all "diffdrive": what makers
// put before and after it goes step by step until the table knows the rest.
std::optional<PluginKind> known_kind(std::string_view text) {
  std::string name = base::to_lower(text);
  if (const std::size_t slash = name.rfind('/'); slash != std::string::npos) name.erase(0, slash + 1);
  if (const std::size_t scope = name.rfind("::"); scope != std::string::npos) name.erase(0, scope + 2);
  if (const std::size_t dot = name.find(".so"); dot != std::string::npos) name.erase(dot);
  if (const std::size_t dot = name.find(".dll"); dot != std::string::npos) name.erase(dot);
  name.erase(std::remove_if(name.begin(), name.end(), [](char c) { return c == '_' || c == '-' || c == ' ' || (c >= '0' && c <= '9'); }),
             name.end());
  const auto look_up = [&]() -> std::optional<PluginKind> {
    std::string_view core = name;
    if (const auto found = table().find(core); found != table().end()) return found->second;
    for (std::string_view suffix : {"system", "plugin"}) {
      if (core.ends_with(suffix) && core.size() > suffix.size()) core.remove_suffix(suffix.size());
    }
    if (const auto found = table().find(core); found != table().end()) return found->second;
    return std::nullopt;
  };
  for (std::string_view prefix : {"", "lib", "ignition", "gazeboros", "gazebo", "gzsim", "gz", "sim"}) {
    if (!name.starts_with(prefix) || name.size() <= prefix.size() + 1) continue;
    name.erase(0, prefix.size());
    if (const auto found = look_up()) return found;
  }
  return look_up();
}

}  // namespace

PluginKind kind_of_plugin(std::string_view filename, std::string_view name) {
  if (const auto found = known_kind(filename)) return *found;
  // The name is the user's own word in Gazebo classic, so that only class names count.
  if (name.find("::") == std::string_view::npos) return PluginKind::unknown;
  return known_kind(name).value_or(PluginKind::unknown);
}

bool is_wheel_drive(PluginKind kind) {
  using enum PluginKind;
  constexpr std::array kinds{differential_drive, skid_steer_drive, car_drive,       mecanum_drive,
                             omni_drive,         tricycle_drive,   tracked_vehicle, track_controller};
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

std::optional<bool> is_of_world(PluginKind kind) {
  using enum PluginKind;
  if (kind == buoyancy || kind == link_wrench || kind == wind_effects) return true;
  if (kind == unknown || kind == implied || kind == label || kind == thermal || kind == thermal_sensor) return std::nullopt;
  return false;
}

std::vector<std::string> tracks_of(const PluginDef& vehicle, std::string_view side) {
  std::vector<std::string> links;
  for (const ParameterNode& track : vehicle.parameters.children) {
    if (track.name != side) continue;
    const ParameterNode* link = track.child("link");
    links.push_back(link != nullptr ? link->text : track.text);
  }
  return links;
}

bool has_own_drive(const ModelDef& model, const PluginDef& plugin) {
  if (kind_of(plugin) != PluginKind::track_controller) return is_wheel_drive(kind_of(plugin));
  const std::string link = plugin.parameters.text_of({"link"}).value_or("");
  return std::none_of(model.plugins.begin(), model.plugins.end(), [&](const PluginDef& vehicle) {
    if (kind_of(vehicle) != PluginKind::tracked_vehicle || vehicle.scope != plugin.scope) return false;
    for (const char* side : {"left_track", "right_track"}) {
      const auto tracks = tracks_of(vehicle, side);
      if (std::find(tracks.begin(), tracks.end(), link) != tracks.end()) return true;
    }
    return false;
  });
}

bool is_steering_only(const PluginDef& plugin) {
  const auto is_set = [&](const char* element) { return plugin.parameters.bool_of({element}).value_or(false); };
  return kind_of(plugin) == PluginKind::car_drive && (is_set("steering_only") || is_set("use_actuator_msg"));
}

bool turns_as_told(const PluginDef& plugin) {
  if (kind_of(plugin) != PluginKind::joint_controller || plugin.parameters.bool_of({"use_force_commands"}).value_or(false)) return false;
  std::string name = base::to_lower(plugin.filename + " " + plugin.name);
  std::erase_if(name, [](char c) { return c == '_' || c == '-'; });
  return name.find("jointcontroller") != std::string::npos;
}

bool is_propeller(PluginKind kind) { return kind == PluginKind::thruster || kind == PluginKind::rotor; }

std::string iface_own_name(const PluginDef& plugin) {
  if (kind_of(plugin) == PluginKind::battery) {
    const std::string name = plugin.parameters.text_of({"battery_name"}).value_or("");
    return name.empty() ? "battery" : name;
  }
  return plugin.name.empty() || plugin.name.find("::") != std::string::npos ? "position2d" : plugin.name;
}

PluginKind kind_of(const PluginDef& plugin) { return kind_of_plugin(plugin.filename, plugin.name); }

}  // namespace sim

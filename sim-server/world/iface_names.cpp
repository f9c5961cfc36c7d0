#include "world/iface_names.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/text.h"
#include "world/complaints.h"
#include "world/plugin_kind.h"
#include "world/taken_names.h"

namespace sim {

namespace {

constexpr std::size_t longest = 120;  // bytes after the model's name; what an iface's name holds in all is 200

std::string joined(const std::string& scope, const std::string& own) { return scope.empty() ? own : scope + "::" + own; }

// The end of the text, in whole characters.
std::string shortened(const std::string& text) {
  if (text.size() <= longest) return text;
  std::size_t start = text.size() - longest;
  while (start < text.size() && (static_cast<unsigned char>(text[start]) & 0xc0) == 0x80) ++start;
  return text.substr(start);
}

std::string scoped_and_short(const std::string& scope, const std::string& own) {
  const std::string full = without_slashes(joined(scope, own));
  return full.size() <= longest ? full : shortened(without_slashes(own));
}

// Sensors of one group make ifaces of the same types.
int group_of(const SensorDef& sensor) {
  switch (sensor.kind) {
    case SensorKind::depth_camera:
    case SensorKind::rgbd_camera:
    case SensorKind::multi_camera:
    case SensorKind::segmentation_camera:
    case SensorKind::box_camera:
    case SensorKind::thermal_camera:
      return static_cast<int>(SensorKind::camera);
    case SensorKind::ray:
      return static_cast<int>(is_sonar(sensor) ? SensorKind::sonar : SensorKind::ray);
    default:
      return static_cast<int>(sensor.kind);
  }
}

// Of plugins whose iface is not called after them.
const char* own_name(PluginKind kind) {
  if (kind == PluginKind::odometry_publisher) return "odometry";
  if (kind == PluginKind::joint_state_publisher) return "joint_states";
  if (kind == PluginKind::buoyancy_engine) return "buoyancy_engine";
  return "position3d";
}

class Namer {
 public:
  Namer(const ModelDef& model, Complaints& complaints) : model_(model), complaints_(complaints) {}

  void name(SensorDef& sensor) {
    if (is_sonar(sensor) && is_of_a_ring(sensor)) {
      sensor.iface = scoped_and_short(sensor.scope, "sonar");
      return;
    }
    sensor.iface = take(taken_[group_of(sensor)], "sensor " + base::in_quotes(sensor.name), sensor.scope, sensor.name);
  }

  void name(PluginDef& plugin) {
    const PluginKind kind = kind_of(plugin);
    if (has_own_drive(model_, plugin))
      plugin.iface = take(drives_, "plugin " + base::in_quotes(plugin.name), plugin.scope, iface_own_name(plugin));
    if (kind == PluginKind::battery)
      plugin.iface = take(batteries_, "battery " + base::in_quotes(plugin.name), plugin.scope, iface_own_name(plugin));
    if (kind == PluginKind::buoyancy_engine)
      plugin.iface = take(drives_, "plugin " + base::in_quotes(plugin.name), plugin.scope, own_name(kind));
    // One way of moving for each model, so one name.
    if (kind == PluginKind::velocity_control || kind == PluginKind::trajectory_follower)
      plugin.iface = scoped_and_short(plugin.scope, "position3d");
    if (kind == PluginKind::odometry_publisher || kind == PluginKind::joint_state_publisher)
      plugin.iface = scoped_and_short(plugin.scope, own_name(kind));
  }

  // Rings have taken their names before the others come.
  void reserve_ring(const SensorDef& sensor) {
    if (is_sonar(sensor) && is_of_a_ring(sensor)) taken_[group_of(sensor)].insert(scoped_and_short(sensor.scope, "sonar"));
  }

 private:
  std::string take(TakenNames& taken, const std::string& what, const std::string& scope, const std::string& own) {
    const std::string name = taken.free(scoped_and_short(scope, own));
    taken.insert(name);
    if (name != joined(scope, own)) {
      complaints_.add(Finding::Severity::warning, {model_.source, 0},
                      "the iface of " + what + " of model " + base::in_quotes(model_.name) + " is called " + base::in_quotes(name) +
                          " after the model; its own name is taken, too long or holds what no iface name can");
    }
    return name;
  }

  const ModelDef& model_;
  Complaints& complaints_;
  std::map<int, TakenNames> taken_;
  TakenNames drives_, batteries_;
};

template <class Do>
void each_sensor(ModelDef& model, Do&& act) {
  for (LinkDef& link : model.links) std::for_each(link.sensors.begin(), link.sensors.end(), act);
  for (JointDef& joint : model.joints) std::for_each(joint.sensors.begin(), joint.sensors.end(), act);
}

std::string after(const ModelDef& model, const std::string& iface, const std::string& scope, const std::string& own) {
  return model.name + "::" + (iface.empty() ? joined(scope, own) : iface);
}

}  // namespace

bool is_sonar(const SensorDef& sensor) {
  return sensor.kind == SensorKind::sonar || (sensor.kind == SensorKind::ray && is_of_a_ring(sensor));
}

bool is_of_a_ring(const SensorDef& sensor) { return base::to_lower(sensor.name).starts_with("sonar"); }

std::string without_slashes(std::string name) {
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c == '/' || c < 32 || c == 127; }, '_');
  return name;
}

void name_ifaces(ModelDef& model, Complaints& complaints) {
  Namer namer(model, complaints);
  each_sensor(model, [&](SensorDef& sensor) { namer.reserve_ring(sensor); });
  each_sensor(model, [&](SensorDef& sensor) { namer.name(sensor); });
  for (PluginDef& plugin : model.plugins) namer.name(plugin);
}

std::string iface_name(const ModelDef& model, const SensorDef& sensor) {
  return after(model, sensor.iface, sensor.scope, is_sonar(sensor) && is_of_a_ring(sensor) ? "sonar" : sensor.name);
}

std::string iface_name(const ModelDef& model, const PluginDef& plugin) {
  const PluginKind kind = kind_of(plugin);
  const bool has_own_name = is_wheel_drive(kind) || kind == PluginKind::battery;
  return after(model, plugin.iface, plugin.scope, has_own_name ? iface_own_name(plugin) : own_name(kind));
}

}  // namespace sim

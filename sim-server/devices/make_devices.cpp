// Which sensors and plugins become which devices.
#include <spdlog/fmt/fmt.h>

#include "base/text.h"
#include "devices/camera.h"
#include "devices/device.h"
#include "devices/laser.h"
#include "devices/meter.h"
#include "devices/position2d.h"
#include "devices/position3d.h"
#include "devices/simple_devices.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

using Made = base::Result<std::unique_ptr<Device>>;

bool is_sonar(const SensorDef& sensor) {
  if (sensor.kind == SensorKind::sonar) return true;
  return sensor.kind == SensorKind::ray && base::to_lower(sensor.name).starts_with("sonar");
}
bool is_of_a_ring(const SensorDef& sensor) { return base::to_lower(sensor.name).starts_with("sonar"); }

bool is_camera(SensorKind kind) {
  return kind == SensorKind::camera || kind == SensorKind::depth_camera || kind == SensorKind::rgbd_camera ||
         kind == SensorKind::multi_camera;
}

struct Makers {
  DeviceWorld& world;
  ModelId model;
  std::vector<std::string>& notes;
  std::vector<std::unique_ptr<Device>> devices;
  std::optional<base::Error> failure;

  void take(Made made) {
    if (made) {
      devices.push_back(std::move(*made));
    } else if (!failure) {
      failure = made.error();
    }
  }
};

void make_sensor(Makers& m, Mount mount, const SensorDef& sensor) {
  switch (sensor.kind) {
    case SensorKind::ray:
      return m.take(Laser::make(m.world, mount, sensor));
    case SensorKind::imu:
      return m.take(Imu::make(m.world, mount, sensor));
    case SensorKind::gps:
      return m.take(Gps::make(m.world, mount, sensor));
    case SensorKind::contact:
      return m.take(Bumper::make(m.world, mount, sensor));
    case SensorKind::altimeter:
    case SensorKind::magnetometer:
    case SensorKind::air_pressure:
      return m.take(Meter::make(m.world, mount, sensor, std::nullopt));
    case SensorKind::force_torque:
      m.notes.push_back(
          fmt::format("model {}: sensor {}: a force_torque sensor measures the joint that it stands in; this one stands in a link",
                      m.world.physics.def(m.model).name, sensor.name));
      return;
    default:
      break;
  }
  if (is_camera(sensor.kind)) {
    auto made = make_cameras(m.world, mount, sensor);
    if (!made && !m.failure) m.failure = made.error();
    if (made) std::move(made->begin(), made->end(), std::back_inserter(m.devices));
    return;
  }
}

void make_joint_sensors(Makers& m) {
  const ModelDef& def = m.world.physics.def(m.model);
  for (std::uint32_t j = 0; j < def.joints.size(); ++j) {
    for (const auto& sensor : def.joints[j].sensors) {
      const auto link = link_of(def, {}, def.joints[j].child.empty() ? def.joints[j].parent : def.joints[j].child);
      if (sensor.kind != SensorKind::force_torque || !link) {
        m.notes.push_back(
            fmt::format("model {}: sensor {}: {} sensors stand in links, not in joints", def.name, sensor.name, to_text(sensor.kind)));
        continue;
      }
      const Eigen::Isometry3d place = def.links[*link].pose.inverse() * def.joints[j].pose_in_model * sensor.pose;
      m.take(Meter::make(m.world, {{m.model, *link}, place}, sensor, JointId{m.model, j}));
    }
  }
}

void make_sonars(Makers& m) {
  const ModelDef& def = m.world.physics.def(m.model);
  std::vector<std::pair<std::string, std::vector<SonarRing::Transducer>>> rings;  // by scope
  for (std::uint32_t l = 0; l < def.links.size(); ++l) {
    for (const auto& sensor : def.links[l].sensors) {
      if (!is_sonar(sensor)) continue;
      const SonarRing::Transducer transducer{{{m.model, l}, sensor.pose}, &sensor};
      if (!is_of_a_ring(sensor)) {
        m.take(SonarRing::make(m.world, iface_name(def.name, sensor.scope, sensor.name), sensor.scope, {transducer}));
        continue;
      }
      auto ring = std::find_if(rings.begin(), rings.end(), [&](const auto& r) { return r.first == sensor.scope; });
      if (ring == rings.end()) ring = rings.insert(rings.end(), {sensor.scope, {}});
      ring->second.push_back(transducer);
    }
  }
  for (const auto& [scope, transducers] : rings) m.take(SonarRing::make(m.world, iface_name(def.name, scope, "sonar"), scope, transducers));
}

// The way points that a drive of the same (nested) model follows while nobody commands it.
std::optional<Path> path_of(Makers& m, const std::string& scope) {
  for (const auto& plugin : m.world.physics.def(m.model).plugins) {
    if (plugin.scope != scope || kind_of(plugin) != PluginKind::trajectory_follower) continue;
    auto path = Path::of(plugin, m.world.physics.model_pose(m.model));
    if (path) return std::move(*path);
    m.notes.push_back(path.error().message);
  }
  return {};
}

// A model with way points and no drive of its own.
void make_follower(Makers& m, const PluginDef& plugin) {
  const auto& plugins = m.world.physics.def(m.model).plugins;
  for (const auto& other : plugins) {
    if (other.scope != plugin.scope) continue;
    if (kind_of(other) == PluginKind::velocity_control) return;  // which flies them
    if (&other != &plugin && kind_of(other) == PluginKind::trajectory_follower && &other < &plugin) {
      m.notes.push_back(
          fmt::format("{}: plugin {}: the model follows the way points of {} already", plugin.source, plugin.name, other.name));
      return;
    }
  }
  if (m.world.physics.is_static(m.model)) {
    m.notes.push_back(fmt::format("{}: plugin {}: the model is static and cannot move", plugin.source, plugin.name));
    return;
  }
  auto path = Path::of(plugin, m.world.physics.model_pose(m.model));
  if (!path) return m.notes.push_back(path.error().message);
  m.take(Position3d::make(m.world, m.model, plugin, std::move(*path)));
}

void make_plugin(Makers& m, const PluginDef& plugin) {
  switch (kind_of(plugin)) {
    case PluginKind::differential_drive:
    case PluginKind::skid_steer_drive:
      // A drive that is wrong is the world's fault, not the machine's: said, left out.
      if (const auto settings = DriveSettings::of(m.world.physics.def(m.model), plugin); !settings) {
        m.notes.push_back(settings.error().message);
        return;
      }
      return m.take(Position2d::make(m.world, m.model, plugin));
    case PluginKind::velocity_control:
      if (m.world.physics.is_static(m.model)) {
        m.notes.push_back(fmt::format("{}: plugin {}: the model is static and cannot move", plugin.source, plugin.name));
        return;
      }
      return m.take(Position3d::make(m.world, m.model, plugin, path_of(m, plugin.scope)));
    case PluginKind::trajectory_follower:
      return make_follower(m, plugin);
    case PluginKind::unsupported_drive:
    case PluginKind::implied:
    case PluginKind::unknown:  // the loader has said so
      return;
  }
}

}  // namespace

base::Result<std::vector<std::unique_ptr<Device>>> make_devices(DeviceWorld& world, ModelId model, std::vector<std::string>& notes) {
  Makers m{world, model, notes, {}, {}};
  const ModelDef& def = world.physics.def(model);
  for (const auto& plugin : def.plugins) make_plugin(m, plugin);
  for (std::uint32_t l = 0; l < def.links.size(); ++l) {
    for (const auto& sensor : def.links[l].sensors) {
      if (!is_sonar(sensor)) make_sensor(m, {{model, l}, sensor.pose}, sensor);
    }
  }
  make_joint_sensors(m);
  make_sonars(m);
  if (!world.physics.is_static(model)) m.take(Truth::make(world, model));
  if (m.failure) return *m.failure;
  return std::move(m.devices);
}

}  // namespace sim

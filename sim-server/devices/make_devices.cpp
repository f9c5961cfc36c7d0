// Which sensors and plugins become which devices.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <map>

#include "base/text.h"
#include "devices/battery.h"
#include "devices/device.h"
#include "devices/drives/buoyancy_engine.h"
#include "devices/drives/position2d.h"
#include "devices/drives/position3d.h"
#include "devices/drives/vehicle3d.h"
#include "devices/joints/joints_device.h"
#include "devices/sensors/camera.h"
#include "devices/sensors/published_states.h"
#include "devices/sensors/sensor_makers.h"
#include "devices/sensors/sonar.h"
#include "devices/sensors/truth.h"
#include "world/iface_names.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

bool is_camera(SensorKind kind) {
  return kind == SensorKind::camera || kind == SensorKind::depth_camera || kind == SensorKind::rgbd_camera ||
         kind == SensorKind::multi_camera || kind == SensorKind::segmentation_camera || kind == SensorKind::box_camera ||
         kind == SensorKind::thermal_camera;
}

struct Makers {
  DeviceWorld& world;
  ModelId model;
  std::vector<std::string>& left_out;
  std::vector<std::unique_ptr<Device>> devices;
  std::optional<base::Error> failure;
  std::map<std::uint32_t, std::string> driven, belts;  // joints and tracks, and the plugins whose motors turn them
  std::shared_ptr<Propellers> propellers;              // null: none

  // False, with a line, for names that are too long: those of models may fill an iface's name alone.
  bool can_name(const std::string& iface, const std::string& what) {
    const auto good = shm::check_name(iface);
    if (!good) left_out.push_back(fmt::format("model {}: {}: {}", world.physics.def(model).name, what, good.error().message));
    return static_cast<bool>(good);
  }
  void take(MadeDevice made) {
    if (made) {
      devices.push_back(std::move(*made));
    } else if (!failure) {
      failure = made.error();
    }
  }
};

void leave_out(Makers& m, const PluginDef& plugin, const std::string& why) {
  m.left_out.push_back(fmt::format("{}: plugin {}: {}; the plugin is left out", plugin.source, plugin.name, why));
}

const SensorMaker* maker_of(SensorKind kind) {
  const auto row = std::find_if(sensor_makers.begin(), sensor_makers.end(), [&](const SensorMaker& maker) { return maker.kind == kind; });
  return row == sensor_makers.end() ? nullptr : &*row;
}

void make_sensor(Makers& m, Mount mount, const SensorDef& sensor) {
  const ModelDef& def = m.world.physics.def(m.model);
  if (!m.can_name(iface_name(def, sensor), "sensor " + sensor.name)) return;
  if (const SensorMaker* maker = maker_of(sensor.kind)) {
    if (sensor.kind == SensorKind::wheels && !missing_wheel(def, sensor).empty()) {
      m.left_out.push_back(fmt::format("model {}: sensor {}: the model has no joint {} that turns about one axis; the sensor is left out",
                                       def.name, sensor.name, base::in_quotes(missing_wheel(def, sensor))));
      return;
    }
    if (!maker->stands_in_joint) return m.take(maker->make({m.world, mount, sensor, std::nullopt}));
    m.left_out.push_back(fmt::format("model {}: sensor {}: a {} sensor measures its joint; this one is in a link", def.name, sensor.name,
                                     to_text(sensor.kind)));
    return;
  }
  if (!is_camera(sensor.kind)) return;
  auto made = make_cameras(m.world, mount, sensor);
  if (!made && !m.failure) m.failure = made.error();
  if (made) std::move(made->begin(), made->end(), std::back_inserter(m.devices));
}

void make_joint_sensors(Makers& m) {
  const ModelDef& def = m.world.physics.def(m.model);
  for (std::uint32_t j = 0; j < def.joints.size(); ++j) {
    for (const auto& sensor : def.joints[j].sensors) {
      const auto link = link_of(def, {}, def.joints[j].child.empty() ? def.joints[j].parent : def.joints[j].child);
      const SensorMaker* maker = maker_of(sensor.kind);
      if (maker == nullptr || !maker->stands_in_joint || !link) {
        m.left_out.push_back(
            fmt::format("model {}: sensor {}: {} sensors belong in links, not in joints", def.name, sensor.name, to_text(sensor.kind)));
        continue;
      }
      if (!m.can_name(iface_name(def, sensor), "sensor " + sensor.name)) continue;
      const Eigen::Isometry3d place = def.links[*link].pose.inverse() * def.joints[j].pose_in_model * sensor.pose;
      m.take(maker->make({m.world, {{m.model, *link}, place}, sensor, JointId{m.model, j}}));
    }
  }
}

void make_sonars(Makers& m) {
  const ModelDef& def = m.world.physics.def(m.model);
  struct Ring {
    std::string scope, iface;
    std::vector<Transducer> transducers;
  };
  std::vector<Ring> rings;  // one for each scope
  for (std::uint32_t l = 0; l < def.links.size(); ++l) {
    for (const auto& sensor : def.links[l].sensors) {
      if (!is_sonar(sensor)) continue;
      const Transducer transducer{{{m.model, l}, sensor.pose}, &sensor};
      const std::string iface = iface_name(def, sensor);
      if (!m.can_name(iface, "sensor " + sensor.name)) continue;
      auto ring = std::find_if(rings.begin(), rings.end(), [&](const Ring& r) { return is_of_a_ring(sensor) && r.iface == iface; });
      if (ring == rings.end()) ring = rings.insert(rings.end(), {sensor.scope, iface, {}});
      ring->transducers.push_back(transducer);
    }
  }
  for (const auto& ring : rings) m.take(make_sonar_ring(m.world, ring.iface, ring.scope, ring.transducers));
}

// The way points that a drive of the same (nested) model follows while nobody commands it.
std::optional<Path> path_of(Makers& m, const std::string& scope) {
  for (const auto& plugin : m.world.physics.def(m.model).plugins) {
    if (plugin.scope != scope || kind_of(plugin) != PluginKind::trajectory_follower) continue;
    auto path = Path::of(plugin, m.world.physics.model_pose(m.model));
    if (path) return std::move(*path);
    m.left_out.push_back(path.error().message);
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
      m.left_out.push_back(
          fmt::format("{}: plugin {}: the model follows the way points of {} already", plugin.source, plugin.name, other.name));
      return;
    }
  }
  if (m.world.physics.is_static(m.model)) {
    m.left_out.push_back(fmt::format("{}: plugin {}: the model is static and cannot move", plugin.source, plugin.name));
    return;
  }
  auto path = Path::of(plugin, m.world.physics.model_pose(m.model));
  if (!path) return m.left_out.push_back(path.error().message);
  m.take(Position3d::make(m.world, m.model, plugin, std::move(*path)));
}

// Why a drive cannot have this joint or track, of its `all`; empty: it can.
std::string taken_by(const std::map<std::uint32_t, std::string>& taken, const std::vector<std::uint32_t>& all, std::size_t place) {
  const auto other = taken.find(all[place]);
  if (other != taken.end()) return " is driven by " + other->second + " already";
  const auto here = all.begin() + static_cast<std::ptrdiff_t>(place);
  return std::find(all.begin(), here, *here) != here ? " is named twice" : "";
}

// False, with a line, for what does not turn or is named twice, and for a second drive of the same wheels or tracks: files that were
// written for several simulators name one drive for each.
bool can_drive(Makers& m, const PluginDef& plugin, const DriveTrain& train) {
  const ModelDef& def = m.world.physics.def(m.model);
  const auto joints = train.joints(), belts = train.belts();
  if (def.is_static && train.moves_the_model()) return leave_out(m, plugin, "the model is static and cannot move"), false;
  std::string why;
  for (std::size_t i = 0; i < joints.size() && why.empty(); ++i) {
    const JointDef& joint = def.joints[joints[i]];
    const std::string problem = joint.axes.empty() ? " turns about no axis" : taken_by(m.driven, joints, i);
    if (!problem.empty()) why = "joint " + base::in_quotes(joint.name) + problem;
  }
  for (std::size_t i = 0; i < belts.size() && why.empty(); ++i) {
    const std::string problem = taken_by(m.belts, belts, i);
    if (!problem.empty()) why = "track " + base::in_quotes(def.links[belts[i]].name) + problem;
  }
  if (!why.empty()) return leave_out(m, plugin, why), false;
  for (const auto joint : joints) m.driven.emplace(joint, plugin.name);
  for (const auto belt : belts) m.belts.emplace(belt, plugin.name);
  return true;
}

// What it publishes without the joints that the model lacks, one line each.
void check_published_joints(Makers& m, const PluginDef& plugin) {
  const ModelDef& def = m.world.physics.def(m.model);
  for (const ParameterNode& child : plugin.parameters.children) {
    if (child.name != "joint_name" && child.name != "jointName") continue;
    for (const std::string& name : base::split_list(child.text)) {
      if (joint_named(def, plugin.scope, name)) continue;
      m.left_out.push_back(fmt::format("{}: plugin {}: model {} has no joint {}; its state is left out", plugin.source, plugin.name,
                                       def.name, base::in_quotes(name)));
    }
  }
}

// Its joint takes efforts by the iface of joints, as all do.
void check_joint_force(Makers& m, const PluginDef& plugin) {
  const ModelDef& def = m.world.physics.def(m.model);
  const std::string name = plugin.parameters.text_of({"joint_name"}).value_or("");
  const auto joint = joint_named(def, plugin.scope, name);
  if (!joint) return leave_out(m, plugin, fmt::format("model {} has no joint {}", def.name, base::in_quotes(name)));
  if (def.joints[*joint].axes.empty()) leave_out(m, plugin, fmt::format("joint {} turns about no axis", base::in_quotes(name)));
}

MadeTrain (*train_maker_of(PluginKind kind))(Physics&, ModelId, const PluginDef&) {
  switch (kind) {
    case PluginKind::car_drive:
    case PluginKind::tricycle_drive:
      return make_car;
    case PluginKind::mecanum_drive:
    case PluginKind::omni_drive:
      return make_rollers;
    case PluginKind::tracked_vehicle:
    case PluginKind::track_controller:
      return make_tracks;
    default:
      return make_wheel_pairs;
  }
}

// Of several such plugins of a (nested) model the first has the iface.
void make_once(Makers& m, const PluginDef& plugin, MadeDevice (*make)(DeviceWorld&, ModelId, const PluginDef&)) {
  for (const auto& other : m.world.physics.def(m.model).plugins) {
    if (&other == &plugin) break;
    if (other.scope == plugin.scope && kind_of(other) == kind_of(plugin)) return leave_out(m, plugin, "the model has one already");
  }
  auto made = make(m.world, m.model, plugin);
  if (!made || *made) m.take(std::move(made));
}

void make_plugin(Makers& m, const PluginDef& plugin) {
  const ModelDef& def = m.world.physics.def(m.model);
  using enum PluginKind;
  constexpr std::array others{velocity_control, trajectory_follower, odometry_publisher, joint_state_publisher, buoyancy_engine};
  const bool has_iface = has_own_drive(def, plugin) || std::find(others.begin(), others.end(), kind_of(plugin)) != others.end();
  if (has_iface && !m.can_name(iface_name(def, plugin), "plugin " + plugin.name)) return;
  switch (kind_of(plugin)) {
    case PluginKind::differential_drive:
    case PluginKind::skid_steer_drive:
    case PluginKind::car_drive:
    case PluginKind::tricycle_drive:
    case PluginKind::mecanum_drive:
    case PluginKind::omni_drive:
    case PluginKind::tracked_vehicle:
    case PluginKind::track_controller: {
      if (!has_own_drive(def, plugin)) return;
      auto train = train_maker_of(kind_of(plugin))(m.world.physics, m.model, plugin);
      // A drive that is wrong is the world's fault, not the machine's: said, left out.
      if (!train) return m.left_out.push_back(train.error().message);
      if (!can_drive(m, plugin, **train)) return;
      return m.take(Position2d::make(m.world, m.model, plugin, std::move(*train)));
    }
    case PluginKind::velocity_control:
      for (const auto& other : def.plugins) {
        if (&other >= &plugin || other.scope != plugin.scope || kind_of(other) != PluginKind::velocity_control) continue;
        m.left_out.push_back(fmt::format("{}: plugin {}: the model is moved by {} already", plugin.source, plugin.name, other.name));
        return;
      }
      if (m.world.physics.is_static(m.model)) {
        m.left_out.push_back(fmt::format("{}: plugin {}: the model is static and cannot move", plugin.source, plugin.name));
        return;
      }
      if (plugin.parameters.child("link_name") != nullptr && def.links.size() > 1)
        m.left_out.push_back(fmt::format("{}: plugin {}: <link_name> is ignored; the whole model moves", plugin.source, plugin.name));
      return m.take(Position3d::make(m.world, m.model, plugin, path_of(m, plugin.scope)));
    case PluginKind::trajectory_follower:
      return make_follower(m, plugin);
    case PluginKind::odometry_publisher:
      return make_once(m, plugin, make_odometry);
    case PluginKind::joint_state_publisher:
      check_published_joints(m, plugin);
      return make_once(m, plugin, make_joint_states);
    case PluginKind::joint_force:
      return check_joint_force(m, plugin);
    case PluginKind::buoyancy_engine: {
      auto made = BuoyancyEngine::make(m.world, m.model, plugin, m.left_out);
      if (!made || *made) m.take(std::move(made));
      return;
    }
    case PluginKind::wheel_slip:  // of the contacts
    case PluginKind::unsupported_drive:
    case PluginKind::joint_controller:  // joint_hold has it
    case PluginKind::detachable_joint:  // Attachments have it
    case PluginKind::battery:           // after all that it drives
    case PluginKind::label:
    case PluginKind::thermal:
    case PluginKind::thermal_sensor:
    case PluginKind::fiducial:  // detectors look for it
    case PluginKind::buoyancy:  // the physics have these
    case PluginKind::hydrodynamics:
    case PluginKind::lift_drag:
    case PluginKind::advanced_lift_drag:
    case PluginKind::lighter_than_air:
    case PluginKind::floating_hull:
    case PluginKind::rotor:  // make_vehicle and the joints have these
    case PluginKind::thruster:
    case PluginKind::multicopter_control:
    case PluginKind::link_wrench:
    case PluginKind::wind_effects:
    case PluginKind::implied:
    case PluginKind::unknown:  // the loader has said so
      return;
  }
}

bool flies_by_itself(const ModelDef& def) {
  return std::any_of(def.plugins.begin(), def.plugins.end(), [](const PluginDef& plugin) {
    return kind_of(plugin) == PluginKind::velocity_control || kind_of(plugin) == PluginKind::trajectory_follower;
  });
}

// A position3d for a model with rotors or thrusters; those of a plugin for multicopters by its numbers.
void make_vehicle(Makers& m) {
  const ModelDef& def = m.world.physics.def(m.model);
  m.propellers = Propellers::of(m.world, m.model, m.driven, m.left_out);
  const auto plugin_of = [&](PluginKind kind) {
    return std::find_if(def.plugins.begin(), def.plugins.end(), [kind](const PluginDef& plugin) { return kind_of(plugin) == kind; });
  };
  const auto control = plugin_of(PluginKind::multicopter_control), none = def.plugins.end();
  if (!m.propellers) {
    if (control != none) {
      m.left_out.push_back(fmt::format("{}: plugin {}: model {} has no rotor; the plugin is left out", control->source,
                                       base::in_quotes(control->name), base::in_quotes(def.name)));
    }
    return;
  }
  const auto& all = m.propellers->all();
  const auto rotors = std::count_if(all.begin(), all.end(), [](const Propeller& propeller) { return propeller.setup().is_rotor; });
  const bool is_copter = control != none || rotors >= 4;
  if (flies_by_itself(def) || (!is_copter && rotors == static_cast<std::ptrdiff_t>(all.size()))) return;
  const PluginDef& plugin = control != none ? *control : is_copter ? *plugin_of(PluginKind::rotor) : *plugin_of(PluginKind::thruster);
  if (!m.can_name(iface_name(def, plugin), "plugin " + plugin.name)) return;
  auto made = is_copter ? make_multicopter(m.world, m.model, plugin, *m.propellers, m.left_out)
                        : make_thruster_control(m.world.physics, m.model, *m.propellers);
  if (made) m.take(Vehicle3d::make(m.world, m.model, plugin, m.propellers, std::move(made)));
}

void make_joints(Makers& m) {
  const ModelDef& def = m.world.physics.def(m.model);
  if (commandable_joints(def).empty() || !m.can_name(JointsDevice::name_of(def), "joints")) return;
  m.take(JointsDevice::make(m.world, m.model, m.propellers));
}

void make_batteries(Makers& m) {
  const ModelDef& def = m.world.physics.def(m.model);
  std::vector<Device*> others;
  for (const auto& device : m.devices) others.push_back(device.get());
  for (const auto& plugin : def.plugins) {
    if (kind_of(plugin) != PluginKind::battery || !m.can_name(iface_name(def, plugin), "plugin " + plugin.name)) continue;
    if (const auto setup = battery_setup(def, plugin)) {
      m.take(Battery::make(m.world, m.model, plugin, *setup, others));
    } else {
      m.left_out.push_back(setup.error().message);
    }
  }
}

}  // namespace

base::Result<std::vector<std::unique_ptr<Device>>> make_devices(DeviceWorld& world, ModelId model, std::vector<std::string>& left_out) {
  Makers m{world, model, left_out, {}, {}, {}, {}, {}};
  const ModelDef& def = world.physics.def(model);
  for (const auto& plugin : def.plugins) make_plugin(m, plugin);
  make_vehicle(m);
  for (std::uint32_t l = 0; l < def.links.size(); ++l) {
    for (const auto& sensor : def.links[l].sensors) {
      if (!is_sonar(sensor)) make_sensor(m, {{model, l}, sensor.pose}, sensor);
    }
  }
  make_joint_sensors(m);
  make_sonars(m);
  make_joints(m);
  make_batteries(m);
  if (!world.physics.is_static(model) && m.can_name(def.name, "true pose")) m.take(make_truth(world, model));
  if (m.failure) return *m.failure;
  return std::move(m.devices);
}

}  // namespace sim

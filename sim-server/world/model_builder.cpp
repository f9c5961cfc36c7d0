#include "world/model_builder.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.h"
#include "world/checks.h"
#include "world/gripper_builder.h"
#include "world/iface_names.h"
#include "world/inertial_builder.h"
#include "world/joint_builder.h"
#include "world/plugin_kind.h"
#include "world/plugin_numbers.h"
#include "world/repairs.h"
#include "world/shape_inertia.h"
#include "world/visual_builder.h"
#include "world/wheel_slip_builder.h"
#include "world/xml_file.h"
#include "world/xml_values.h"

namespace sim {

namespace {

double friction_at(pugi::xml_node surface, std::string_view path) {
  const double mu = number_at(surface, path, 1);
  if (mu < 0) return infinite;  // -1 is a common spelling of "never slips"
  return mu;
}

std::uint16_t bitmask_at(pugi::xml_node node, std::string_view path) {
  const std::string text = text_at(node, path);
  if (text.empty()) return 0xffff;
  return static_cast<std::uint16_t>(std::strtoul(text.c_str(), nullptr, 0) & 0xffffU);
}

SurfaceDef build_surface(pugi::xml_node node) {
  SurfaceDef surface;
  if (!node) return surface;
  surface.mu = friction_at(node, "friction/ode/mu");
  surface.mu2 = child_at(node, "friction/ode/mu2")  ? friction_at(node, "friction/ode/mu2")
                : child_at(node, "friction/ode/mu") ? surface.mu
                                                    : 1;
  const Eigen::Vector3d direction = vector3_at(node, "friction/ode/fdir1", Eigen::Vector3d::Zero());
  if (direction.allFinite() && direction.norm() > 1e-9) surface.friction_direction = direction.normalized();
  surface.slip1 = std::max(0.0, number_at(node, "friction/ode/slip1", 0));
  surface.slip2 = std::max(0.0, number_at(node, "friction/ode/slip2", 0));
  if (child_at(node, "friction/torsional")) surface.torsional_mu = std::max(0.0, number_at(node, "friction/torsional/coefficient", 1));
  surface.restitution = std::clamp(number_at(node, "bounce/restitution_coefficient", 0), 0.0, 1.0);
  surface.bounce_threshold = std::max(0.0, number_at(node, "bounce/threshold", 100000));
  const std::optional<double> kp = number_at(node, "contact/ode/kp"), kd = number_at(node, "contact/ode/kd");
  if (kp && *kp > 0 && std::isfinite(*kp)) surface.kp = kp;
  if (kd && *kd > 0 && std::isfinite(*kd)) surface.kd = kd;
  surface.max_vel = std::max(0.0, number_at(node, "contact/ode/max_vel", 0.01));
  surface.min_depth = std::max(0.0, number_at(node, "contact/ode/min_depth", 0));
  surface.soft_cfm = std::max(0.0, number_at(node, "contact/ode/soft_cfm", 0));
  surface.soft_erp = std::clamp(number_at(node, "contact/ode/soft_erp", 0.2), 0.0, 1.0);
  surface.collide_without_contact = bool_at(node, "contact/collide_without_contact", false);
  surface.collide_bitmask = bitmask_at(node, "contact/collide_bitmask");
  surface.category_bitmask = bitmask_at(node, "contact/category_bitmask");
  return surface;
}

std::optional<CollisionDef> build_collision(pugi::xml_node node, BuildContext& context) {
  std::optional<GeometryDef> geometry = build_geometry(node.child("geometry"), context);
  if (!geometry) return std::nullopt;
  CollisionDef collision;
  collision.name = node.attribute("name").value();
  collision.pose = pose_at(node, "pose") * ground_in_shape(node.child("geometry"), *geometry);
  collision.geometry = std::move(*geometry);
  collision.surface = build_surface(node.child("surface"));
  collision.laser_retro = number_at(node, "laser_retro", 0);
  return collision;
}

}  // namespace

PluginDef build_plugin(pugi::xml_node node, const std::string& scope, BuildContext& context) {
  PluginDef plugin;
  plugin.name = node.attribute("name").value();
  plugin.filename = node.attribute("filename").value();
  plugin.scope = scope;
  plugin.parameters = parameters_of(node);
  plugin.source = context.complaints.place_of(node).text();
  const bool is_in_world = std::string_view(node.parent().name()) == "world";
  // Gazebo Classic has a plugin of models with the name of the other simulator's plugin of worlds.
  const bool is_other = kind_of(plugin) == PluginKind::buoyancy && !is_in_world && plugin.filename.starts_with("libBuoyancyPlugin");
  if (!is_other && is_of_world(kind_of(plugin)).value_or(is_in_world) != is_in_world) {
    context.complaints.warn(node,
                            describe_in_context(node) +
                                (is_in_world ? " means a model, but stands in the world" : " means the world, but stands in a model") +
                                "; it is ignored");
  } else if (kind_of(plugin) == PluginKind::unsupported_drive) {
    context.complaints.warn(node, "drive " + base::in_quotes(plugin.filename.empty() ? plugin.name : plugin.filename) + " (" +
                                      describe_in_context(node) + ") is not simulated; nothing drives the model");
  } else if (kind_of(plugin) == PluginKind::joint_controller) {
    context.complaints.warn(
        node, describe_in_context(node) +
                  " is not commanded: its joints keep the position or speed that it starts with, until a client of the iface joints "
                  "commands them");
    check_numbers(node, plugin, context.complaints);
  } else if (is_other || kind_of(plugin) == PluginKind::unknown) {
    context.complaints.warn(node, "unknown plugin " + base::in_quotes(plugin.filename) + " (" + describe_in_context(node) + ") is ignored");
  } else if (kind_of(plugin) != PluginKind::implied) {
    check_numbers(node, plugin, context.complaints);
  }
  return plugin;
}

namespace {

class ModelBuilder {
 public:
  ModelBuilder(ModelDef& model, BuildContext& context) : model_(model), context_(context) {}

  void add(pugi::xml_node node, const ResolvedModel& resolved, const std::string& scope, const Eigen::Isometry3d& place) {
    const std::size_t first_nested = model_.nested.size(), first_link = model_.links.size();
    if (!scope.empty()) model_.nested.push_back({scope, place, 0});
    for (pugi::xml_node nested : node.children("model")) {
      const auto inner = resolved.models.find(nested.attribute("name").value());
      if (inner == resolved.models.end()) continue;
      if (bool_at(nested, "static", false) && !model_.is_static) {
        context_.complaints.warn(nested, describe_in_context(nested) + " is static in a model that is not; it moves with the model");
      }
      add(nested, inner->second, scoped(scope, inner->first), place * inner->second.pose);
    }
    for (pugi::xml_node link : node.children("link")) add_link(link, resolved, scope, place);
    if (!scope.empty()) hang_nested(first_nested, first_link);
    for (pugi::xml_node joint : node.children("joint")) add_joint(joint, resolved, scope, place);
    for (pugi::xml_node plugin : node.children("plugin")) {
      model_.plugins.push_back(build_plugin(plugin, scope, context_));
      if (is_imu_without_sensor(model_.plugins.back())) add_imu(plugin, model_.plugins.back());
      if (kind_of(model_.plugins.back()) == PluginKind::wheel_slip) add_wheel_slips(plugin, scope, model_, context_.complaints);
    }
    for (pugi::xml_node gripper : node.children("gripper")) add_gripper(gripper, scope, model_, context_.complaints);
    for (pugi::xml_node plugin : node.children("plugin")) add_grasp_fix(plugin, scope, model_, context_.complaints);
  }

  // Why its limits keep a joint from ever following its leader: the stops of both would fight against the follower's row.
  static std::string why_out_of_reach(const JointDef& follower, const JointDef& leader) {
    const AxisDef &own = follower.axes[0], &other = leader.axes[0];
    const MimicDef& mimic = *follower.mimic;
    const auto goal = [&](double position) {
      return mimic.multiplier == 0 ? mimic.offset : mimic.multiplier * (position - mimic.reference) + mimic.offset;
    };
    const auto [low, high] = std::minmax({goal(other.lower), goal(other.upper)});
    const double slack = 1e-9 * (1 + std::abs(own.lower) + std::abs(own.upper));
    if (own.lower > own.upper || other.lower > other.upper || (high >= own.lower - slack && low <= own.upper + slack)) return {};
    const auto text = [](double a, double b) { return base::format_number(a) + " to " + base::format_number(b); };
    return "it would have to be at " + text(low, high) + ", beyond its limits " + text(own.lower, own.upper);
  }

  // Joints that follow one that is not there, themselves, or in a ring: these would hold each other, and none could be commanded.
  void check_mimics() {
    const auto find = [&](const std::string& name) -> JointDef* {
      const auto found = std::find_if(model_.joints.begin(), model_.joints.end(), [&](const JointDef& one) { return one.name == name; });
      return found == model_.joints.end() ? nullptr : &*found;
    };
    for (const auto& [name, node] : followers_) {
      JointDef& joint = *find(name);
      const std::string leader = joint.mimic->leader;
      const JointDef* next = find(leader);
      const bool leads = next != nullptr && next->axes.size() == 1;
      for (std::size_t i = 0; leads && next != nullptr && next != &joint && next->mimic && i < model_.joints.size(); ++i)
        next = find(next->mimic->leader);
      std::string why = !leads ? "there is no such joint with one axis" : next == &joint ? "it would follow itself" : "";
      if (why.empty()) why = why_out_of_reach(joint, *find(leader));
      if (why.empty()) continue;
      context_.complaints.warn(
          node, describe_in_context(node) + " does not mimic joint " + base::in_quotes(leader) + ": " + why + "; it moves on its own");
      joint.mimic.reset();
    }
  }

  // Wheels without <inertial>: those of a small robot would keep it from turning with the specification's 1 kg m^2.
  void weigh_wheels() {
    pugi::xml_node first;
    std::size_t count = 0;
    for (const JointDef& joint : model_.joints) {
      const auto node = weightless_.find(joint.child);
      const auto link = std::find_if(model_.links.begin(), model_.links.end(), [&](const LinkDef& one) { return one.name == joint.child; });
      if (node == weightless_.end() || link == model_.links.end() || !is_wheel(joint, *link)) continue;
      const std::optional<Eigen::Matrix3d> inertia = inertia_of_shapes(link->collisions, link->mass, context_.triangles);
      if (!inertia) continue;
      link->inertia = *inertia;
      if (count++ == 0) first = node->second;
    }
    if (count == 0) return;
    const std::string others =
        count == 1 ? "" : ", and so for " + std::to_string(count - 1) + (count == 2 ? " other wheel" : " other wheels");
    context_.complaints.note(first,
                             describe_in_context(first) + " has no <inertial>; 1 kg and the inertia of its collisions are taken" + others);
  }

  // One line for all links of the model: many robots give no inertia at all.
  void tell_of_inertias() const {
    if (weighed_ == 0) return;
    const std::string others =
        weighed_ == 1 ? ""
                      : ", and so for " + std::to_string(weighed_ - 1) + (weighed_ == 2 ? " other link" : " other links") + " of the model";
    context_.complaints.note(first_weighed_, "<inertial> of " + describe_in_context(first_weighed_.parent()) +
                                                 " has a mass and no <inertia>; that of its collisions is taken" + others);
  }

 private:
  // The frame of a nested model on its first link; without links there is nothing to move with.
  void hang_nested(std::size_t index, std::size_t link) {
    if (link == model_.links.size()) {
      model_.nested.erase(model_.nested.begin() + static_cast<std::ptrdiff_t>(index));
      return;
    }
    NestedDef& nested = model_.nested[index];
    nested.link = static_cast<std::uint32_t>(link);
    nested.pose = model_.links[link].pose.inverse() * nested.pose;
  }

  static bool is_wheel(const JointDef& joint, const LinkDef& link) {
    const bool turns_on = (joint.kind == JointDef::Kind::revolute || joint.kind == JointDef::Kind::continuous) && !joint.axes.empty() &&
                          !std::isfinite(joint.axes[0].lower) && !std::isfinite(joint.axes[0].upper);
    return turns_on && !link.collisions.empty() && std::all_of(link.collisions.begin(), link.collisions.end(), [](const CollisionDef& c) {
             return std::holds_alternative<CylinderShape>(c.geometry) || std::holds_alternative<SphereShape>(c.geometry);
           });
  }

  // The pose of something in a link: its own, or that of the frame that stands for it.
  Eigen::Isometry3d pose_in_link(pugi::xml_node node, const Eigen::Isometry3d& raw, const Eigen::Isometry3d& link,
                                 const ResolvedModel& resolved) const {
    const auto frame = resolved.frames.find(node.attribute(frame_of_pose_mark).value());
    return frame == resolved.frames.end() ? raw : link.inverse() * frame->second;
  }

  void add_link(pugi::xml_node node, const ResolvedModel& resolved, const std::string& scope, const Eigen::Isometry3d& place) {
    const std::string own_name = node.attribute("name").value();
    const auto pose = resolved.links.find(own_name);
    if (pose == resolved.links.end()) return;
    LinkDef link;
    link.name = scoped(scope, own_name);
    link.scope = scope;
    link.pose = place * pose->second;
    link.gravity = bool_at(node, "gravity", true);
    link.kinematic = bool_at(node, "kinematic", false);
    link.self_collide = bool_at(node, "self_collide", model_.self_collide);
    link.enable_wind = bool_at(node, "enable_wind", model_.enable_wind);
    link.linear_damping = number_at(node, "velocity_decay/linear", 0);
    link.angular_damping = number_at(node, "velocity_decay/angular", 0);
    build_inertial(link, node.child("inertial"), model_.is_static, context_);
    for (pugi::xml_node child : node.children("collision")) {
      if (auto built = build_collision(child, context_)) {
        built->pose = pose_in_link(child, built->pose, pose->second, resolved);
        find_friction_frame(child, built->surface, scope, resolved);
        link.collisions.push_back(std::move(*built));
      }
    }
    for (pugi::xml_node child : node.children("visual")) {
      if (auto built = build_visual(child, context_)) {
        built->pose = pose_in_link(child, built->pose, pose->second, resolved);
        link.visuals.push_back(std::move(*built));
      }
    }
    take_retro_of_visuals(node, link);
    for (pugi::xml_node child : node.children("light")) {
      if (auto built = build_light(child, context_)) {
        built->pose = pose_in_link(child, built->pose, pose->second, resolved);
        link.lights.push_back(std::move(*built));
      }
    }
    for (pugi::xml_node child : node.children("sensor")) {
      if (auto built = build_sensor(child, context_)) {
        built->pose = pose_in_link(child, built->pose, pose->second, resolved);
        finish_sensor(*built, child, scope, &link);
        link.sensors.push_back(std::move(*built));
      }
    }
    if (const pugi::xml_node inertial = node.child("inertial"); inertial.attribute(automatic_mark) && !model_.is_static) {
      take_automatic_inertia(link, inertial, context_);
    } else if (inertial.child("mass") && !inertial.child("inertia") && !model_.is_static) {
      take_inertia_of_shapes(link, inertial);
    } else if (!inertial && !model_.is_static) {
      weightless_.emplace(link.name, node);
    }
    for (const char* kind : {"projector", "audio_sink", "audio_source", "battery", "particle_emitter"}) {
      if (std::string_view(kind) == "battery" && has_battery_plugin(node.parent())) continue;
      for (pugi::xml_node child : node.children(kind))
        context_.complaints.warn(child, describe_in_context(child) + " is not simulated and ignored");
    }
    model_.links.push_back(std::move(link));
  }

  // Which has what Gazebo classic reads from the <battery> of a link.
  static bool has_battery_plugin(pugi::xml_node model) {
    const auto plugins = model.children("plugin");
    return std::any_of(plugins.begin(), plugins.end(), [](pugi::xml_node plugin) {
      return kind_of_plugin(plugin.attribute("filename").value(), plugin.attribute("name").value()) == PluginKind::battery;
    });
  }

  // The link that a frame moves with; empty: there is none of that name.
  static std::string link_of_frame(pugi::xml_node model, std::string name, const ResolvedModel& resolved) {
    constexpr int longest_chain = 100;
    for (int i = 0; i < longest_chain; ++i) {
      if (resolved.links.contains(name)) return name;
      if (name == "__model__" || name.empty()) return resolved.canonical_link;
      const pugi::xml_node frame = model.find_child_by_attribute("frame", "name", name.c_str());
      if (!frame) return {};
      name = frame.attribute("attached_to").value();
    }
    return {};
  }

  // <fdir1 gz:expressed_in="...">: the direction keeps to that frame, where it would turn with a wheel.
  void find_friction_frame(pugi::xml_node collision, SurfaceDef& surface, const std::string& scope, const ResolvedModel& resolved) {
    if (!surface.friction_direction) return;
    const pugi::xml_node direction = child_at(collision, "surface/friction/ode/fdir1");
    for (const char* key : {"gz:expressed_in", "ignition:expressed_in", "expressed_in"}) {
      const std::string frame = direction.attribute(key).value();
      if (frame.empty()) continue;
      const std::string link = link_of_frame(collision.parent().parent(), frame, resolved);
      const auto place = resolved.links.find(link);
      if (place == resolved.links.end()) {
        context_.complaints.warn(direction, "<fdir1> of " + describe_in_context(collision) + " is expressed in " + base::in_quotes(frame) +
                                                ", which is no link or frame of the model; it is taken in the frame of the collision");
        return;
      }
      const auto own = resolved.frames.find(frame);
      if (own != resolved.frames.end())
        surface.friction_direction = place->second.linear().transpose() * own->second.linear() * *surface.friction_direction;
      surface.friction_link = scoped(scope, link);
      return;
    }
  }

  // The specification's 1 kg m^2 makes a wheel of 0.1 kg turn like one of 100 kg.
  void take_inertia_of_shapes(LinkDef& link, pugi::xml_node inertial) {
    const std::optional<Eigen::Matrix3d> inertia = inertia_of_shapes(link.collisions, link.mass, context_.triangles);
    if (!inertia) return;
    std::string why;
    link.inertia = repaired_inertia(*inertia, link.mass, why);
    if (weighed_++ == 0) first_weighed_ = inertial;
  }

  // Lasers of gz-sim see the visuals: where collisions are silent about their reflection, that of the nearest visual counts.
  static void take_retro_of_visuals(pugi::xml_node node, LinkDef& link) {
    if (std::all_of(link.visuals.begin(), link.visuals.end(), [](const VisualDef& visual) { return visual.laser_retro == 0; })) return;
    for (pugi::xml_node child : node.children("collision")) {
      if (child.child("laser_retro")) return;
    }
    constexpr std::size_t max_comparisons = 10'000'000;
    if (link.collisions.size() * link.visuals.size() > max_comparisons) return;
    for (CollisionDef& collision : link.collisions) {
      const auto distance = [&](const VisualDef& visual) {
        return (visual.pose.translation() - collision.pose.translation()).squaredNorm();
      };
      collision.laser_retro = std::min_element(link.visuals.begin(), link.visuals.end(), [&](const VisualDef& a, const VisualDef& b) {
                                return distance(a) < distance(b);
                              })->laser_retro;
    }
  }

  void finish_sensor(SensorDef& sensor, pugi::xml_node node, const std::string& scope, const LinkDef* link) {
    sensor.scope = scope;
    for (pugi::xml_node plugin : node.children("plugin")) {
      sensor.plugins.push_back(build_plugin(plugin, scope, context_));
      auto* cameras = std::get_if<CameraSetDef>(&sensor.data);
      if (cameras == nullptr || kind_of(sensor.plugins.back()) != PluginKind::thermal_sensor) continue;
      for (CameraDef& camera : cameras->cameras) read_thermal_sensor(plugin, sensor.plugins.back(), camera.thermal, context_.complaints);
    }
    auto* contact = std::get_if<ContactDef>(&sensor.data);
    if (!contact || !link) return;
    std::vector<std::string> found;
    for (const std::string& name : contact->collisions) {
      // Names may come with the model and link before them.
      const std::size_t last = name.rfind("::");
      const std::string own = last == std::string::npos ? name : name.substr(last + 2);
      const bool exists =
          std::any_of(link->collisions.begin(), link->collisions.end(), [&](const CollisionDef& c) { return c.name == own; });
      if (exists) {
        found.push_back(own);
      } else {
        context_.complaints.warn(
            node, describe_in_context(node) + " names the collision " + base::in_quotes(name) + ", which its link does not have");
      }
    }
    contact->collisions = std::move(found);
  }

  // The plugins of ROS that are an IMU themselves, in a link that they name.
  static bool is_imu_without_sensor(const PluginDef& plugin) {
    return plugin.filename.ends_with("gazebo_ros_imu.so") && plugin.parameters.text_of({"bodyName", "body_name"}).has_value();
  }

  void add_imu(pugi::xml_node node, const PluginDef& plugin) {
    const std::string body = *plugin.parameters.text_of({"bodyName", "body_name"});
    const std::string name = scoped(plugin.scope, body);
    const auto link = std::find_if(model_.links.begin(), model_.links.end(), [&](const LinkDef& l) { return l.name == name; });
    if (link == model_.links.end()) {
      context_.complaints.drop(
          node, describe_in_context(node) + " names the link " + base::in_quotes(body) + ", which does not exist; there is no IMU");
      return;
    }
    SensorDef sensor;
    sensor.name = plugin.name;
    sensor.scope = plugin.scope;
    sensor.kind = SensorKind::imu;
    sensor.type = "imu";
    const auto triple = [&](const char* key) {
      const auto numbers = parse_numbers(plugin.parameters.text_of({key}).value_or(""));
      const bool is_sound = numbers && numbers->size() == 3 && Eigen::Vector3d(numbers->data()).cwiseAbs().maxCoeff() < 1e9;
      return is_sound ? Eigen::Vector3d(numbers->data()) : Eigen::Vector3d(0, 0, 0);
    };
    const Eigen::Vector3d angles = triple("rpyOffset");
    sensor.pose.translation() = triple("xyzOffset");
    sensor.pose.rotate(Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                       Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()));
    sensor.update_rate = std::clamp(plugin.parameters.number_of({"updateRate", "update_rate"}).value_or(0), 0.0, 1e6);
    ImuDef imu;
    if (const double noise = plugin.parameters.number_of({"gaussianNoise", "gaussian_noise"}).value_or(0); noise > 0 && noise < 1e6) {
      for (auto* group : {&imu.angular_velocity, &imu.linear_acceleration}) {
        for (NoiseDef& axis : *group) axis.kind = NoiseDef::Kind::gaussian, axis.stddev = noise;
      }
    }
    sensor.data = imu;
    link->sensors.push_back(std::move(sensor));
  }

  void add_joint(pugi::xml_node node, const ResolvedModel& resolved, const std::string& scope, const Eigen::Isometry3d& place) {
    const auto found = resolved.joints.find(node.attribute("name").value());
    if (found == resolved.joints.end()) return;
    JointDef joint = build_joint(node, found->second, scope, place, model_, context_.complaints);
    for (pugi::xml_node child_node : node.children("sensor")) {
      if (auto built = build_sensor(child_node, context_)) {
        built->pose = pose_in_link(child_node, built->pose, found->second.pose, resolved);
        finish_sensor(*built, child_node, scope, nullptr);
        if (auto* force = std::get_if<ForceTorqueDef>(&built->data)) force->joint = joint.name;
        joint.sensors.push_back(std::move(*built));
      }
    }
    if (joint.mimic) followers_.emplace_back(joint.name, node);
    model_.joints.push_back(std::move(joint));
  }

  ModelDef& model_;
  BuildContext& context_;
  std::size_t weighed_ = 0;  // links whose inertia is that of their shapes
  pugi::xml_node first_weighed_;
  std::map<std::string, pugi::xml_node> weightless_;               // links without <inertial>
  std::vector<std::pair<std::string, pugi::xml_node>> followers_;  // joints with a <mimic>
};

}  // namespace

namespace {

// A model that only wraps static ones is static too, whatever it says; people put a name and a pose on an included piece of furniture that
// way.
bool is_static_model(pugi::xml_node model) {
  if (bool_at(model, "static", false)) return true;
  if (model.child("link") || !model.child("model")) return false;
  for (pugi::xml_node nested : model.children("model")) {
    if (!is_static_model(nested)) return false;
  }
  return true;
}

}  // namespace

ModelDef build_model(pugi::xml_node node, const ResolvedModel& resolved, BuildContext& context) {
  ModelDef model;
  model.name = node.attribute("name").value();
  model.pose = resolved.pose;
  model.is_static = is_static_model(node);
  model.self_collide = bool_at(node, "self_collide", false);
  model.allow_auto_disable = bool_at(node, "allow_auto_disable", true);
  model.enable_wind = bool_at(node, "enable_wind", false);
  model.source = context.complaints.place_of(node).text();
  ModelBuilder builder(model, context);
  builder.add(node, resolved, {}, Eigen::Isometry3d::Identity());
  builder.check_mimics();
  builder.weigh_wheels();
  builder.tell_of_inertias();
  model.canonical_link = resolved.canonical_link;
  if (!model.link(model.canonical_link) && !model.links.empty()) model.canonical_link = model.links.front().name;
  inherit_labels(model);
  name_ifaces(model, context.complaints);
  return model;
}

}  // namespace sim

#include "devices/sensors/published_states.h"

#include <algorithm>

#include "base/text.h"
#include "devices/joints/joint_list.h"
#include "world/iface_names.h"
#include "world/xml_values.h"

namespace sim {
namespace {

Eigen::Vector3d triple_of(const PluginDef& plugin, const char* name) {
  const auto numbers = parse_numbers(plugin.parameters.text_of({name}).value_or(""));
  const bool is_sound = numbers && numbers->size() == 3 && Eigen::Vector3d(numbers->data()).cwiseAbs().maxCoeff() < 1e9;
  return is_sound ? Eigen::Vector3d(numbers->data()) : Eigen::Vector3d(0, 0, 0);
}

class PublishedOdometry final : public Sensor {
 public:
  PublishedOdometry(Setup setup, const Eigen::Isometry3d& offset, bool is_flat, bool is_noisy)
      : Sensor(std::move(setup)), offset_(offset), is_flat_(is_flat), is_noisy_(is_noisy) {}

 private:
  void measure(const Moment&) const override {
    auto& out = sample<shm::TruthSample>();
    Eigen::Isometry3d pose = physics().model_pose(model()) * offset_;
    const LinkId link = physics().canonical_link(model());
    Eigen::Vector3d v = physics().point_velocity(link, pose.translation()), w = physics().link_twist(link).angular;
    if (is_flat_) {
      pose.linear() = Eigen::AngleAxisd(disturbed(2, yaw_of(pose)), Eigen::Vector3d::UnitZ()).toRotationMatrix();
      pose.translation().z() = v.z() = w.x() = w.y() = 0;
    } else {
      pose.translation().z() = disturbed(2, pose.translation().z());
    }
    pose.translation().x() = disturbed(0, pose.translation().x());
    pose.translation().y() = disturbed(1, pose.translation().y());
    out.pose = to_pose(pose);
    for (int i = 0; i < 3; ++i) out.velocity[i] = v[i], out.velocity[i + 3] = w[i];
  }
  double disturbed(std::size_t channel, double value) const { return is_noisy_ ? noisy(channel, value) : value; }

  Eigen::Isometry3d offset_;
  bool is_flat_, is_noisy_;
};

class PublishedJoints final : public Sensor {
 public:
  PublishedJoints(Setup setup, std::vector<std::uint32_t> joints) : Sensor(std::move(setup)), joints_(std::move(joints)) {}

 private:
  void measure(const Moment&) const override {
    constexpr double still = 1e-3;  // [rad/s] or [m/s]
    auto& out = sample<shm::JointsSample>();
    out.count = static_cast<std::uint32_t>(joints_.size());
    out.commanded = 0;
    const std::span<shm::JointState> states = followers<shm::JointState>(0);
    for (std::size_t i = 0; i < joints_.size(); ++i) {
      const JointState now = physics().joint_state({model(), joints_[i]});
      const bool is_still = std::abs(now.velocity) < still;
      states[i] = {now.position, now.velocity, 0, 0, RTMSIM_JOINT_NONE, is_still ? RTMSIM_JOINT_IDLE : RTMSIM_JOINT_MOVING};
    }
  }

  std::vector<std::uint32_t> joints_;
};

bool has_one_axis(const JointDef& joint) {
  using Kind = JointDef::Kind;
  return joint.axes.size() == 1 && (joint.kind == Kind::revolute || joint.kind == Kind::continuous || joint.kind == Kind::prismatic);
}

// Those that the plugin names, in one element each or in a list; else all of them.
std::vector<std::uint32_t> published_joints(const ModelDef& model, const PluginDef& plugin) {
  std::vector<std::uint32_t> joints;
  bool is_named = false;
  for (const ParameterNode& child : plugin.parameters.children) {
    if (child.name != "joint_name" && child.name != "jointName") continue;
    is_named = true;
    for (const std::string& part : base::split_list(child.text)) {
      const auto joint = joint_of(model, plugin.scope, part);
      if (joint && has_one_axis(model.joints[*joint]) && std::find(joints.begin(), joints.end(), *joint) == joints.end())
        joints.push_back(*joint);
    }
  }
  for (std::uint32_t j = 0; j < model.joints.size() && !is_named; ++j) {
    if (has_one_axis(model.joints[j]) && model.joints[j].scope == plugin.scope) joints.push_back(j);
  }
  return joints;
}

shm::Joint joint_entry(const JointDef& def, std::uint32_t id) {
  shm::Joint joint{};
  shm::set_text(joint.name, def.name);
  shm::set_text(joint.link, def.child);
  joint.id = id;
  joint.kind = def.kind == JointDef::Kind::prismatic ? RTMSIM_JOINT_SLIDES : RTMSIM_JOINT_TURNS;
  const bool has_limits = def.kind != JointDef::Kind::continuous;
  joint.lower = has_limits ? def.axes[0].lower : -infinite, joint.upper = has_limits ? def.axes[0].upper : infinite;
  joint.max_velocity = def.axes[0].velocity, joint.max_effort = def.axes[0].effort;
  joint.rest = def.axes[0].initial_position;
  for (int k = 0; k < 3; ++k) joint.axis[k] = def.axes[0].xyz[k];
  joint.pose = to_pose(def.pose_in_model);
  return joint;
}

}  // namespace

MadeDevice make_odometry(DeviceWorld& world, ModelId model, const PluginDef& plugin) {
  const ModelDef& def = world.physics.def(model);
  const ParameterNode& p = plugin.parameters;
  shm::TruthInfo info{};
  shm::set_text(info.model, scoped_model(def, plugin.scope));
  const double rate = std::clamp(p.number_of({"odom_publish_frequency"}).value_or(50), 0.0, 1e6);
  const double deviation = std::max(0.0, p.number_of({"gaussian_noise"}).value_or(0));
  NoiseDef noise;
  if (deviation > 0) noise.kind = NoiseDef::Kind::gaussian, noise.stddev = deviation;
  const Eigen::Vector3d angles = triple_of(plugin, "rpy_offset");
  Eigen::Isometry3d offset = Eigen::Isometry3d::Identity();
  offset.translation() = triple_of(plugin, "xyz_offset");
  offset.rotate(Eigen::AngleAxisd(angles.z(), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(angles.y(), Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(angles.x(), Eigen::Vector3d::UnitX()));
  const bool is_flat = p.number_of({"dimensions"}).value_or(2) != 3;
  auto setup = set_up(world, model, rate, shm::iface_spec(shm::IfaceType::truth, iface_name(def, plugin), info),
                      deviation > 0 ? std::vector<NoiseDef>(3, noise) : std::vector<NoiseDef>());
  if (!setup) return setup.error();
  return MadeDevice(std::make_unique<PublishedOdometry>(std::move(*setup), offset, is_flat, deviation > 0));
}

MadeDevice make_joint_states(DeviceWorld& world, ModelId model, const PluginDef& plugin) {
  const ModelDef& def = world.physics.def(model);
  const auto joints = published_joints(def, plugin), commandable = commandable_joints(def);
  const auto is_known = [&](std::uint32_t joint) { return std::find(commandable.begin(), commandable.end(), joint) != commandable.end(); };
  if (std::all_of(joints.begin(), joints.end(), is_known)) return std::unique_ptr<Device>();
  const double rate = std::clamp(plugin.parameters.number_of({"update_rate", "updateRate"}).value_or(0), 0.0, 1e6);
  shm::JointsInfo info{};
  info.rate = stated_rate(world, rate);
  shm::set_text(info.model, scoped_model(def, plugin.scope));
  std::vector<shm::Joint> entries;
  for (const auto joint : joints) entries.push_back(joint_entry(def.joints[joint], static_cast<std::uint32_t>(entries.size())));
  auto spec = shm::joints_spec(iface_name(def, plugin), info, entries);
  spec.geometry.command_values = 0;
  auto setup = set_up(world, model, rate, spec, {});
  if (!setup) return setup.error();
  return MadeDevice(std::make_unique<PublishedJoints>(std::move(*setup), joints));
}

}  // namespace sim

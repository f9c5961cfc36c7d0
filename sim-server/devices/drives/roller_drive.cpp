// Wheels with rollers on their rims: each pushes along one line and rolls freely across it. How fast the rims must turn for a velocity is
// one row for each wheel; the encoders give the velocity back by least squares, so that one wheel that slips does not decide alone.
#include <spdlog/fmt/fmt.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/text.h"
#include "devices/angle.h"
#include "devices/drives/drive_train.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

struct RollerWheel {
  std::uint32_t joint = 0;
  Eigen::RowVector3d row;  // speed of its rim for each of vx, vy, va
};

struct RollerSettings {
  std::vector<RollerWheel> wheels;
  double radius = 0;                                      // [m]
  double separation = 0, wheel_base = 0;                  // [m]
  double torque = strongest_torque;                       // [N m]
  double max_speed = 0, max_yaw_rate = 0;                 // 0: unlimited [m/s], [rad/s]
  double max_acceleration = 0, max_yaw_acceleration = 0;  // 0: unlimited [m/s^2], [rad/s^2]
  double rate = 0;                                        // of samples [Hz]; 0: every step
};

// Four wheels with rollers at 45 degrees, as gz-sim counts them.
base::Result<void> find_mecanum_wheels(const ModelDef& model, const PluginDef& plugin, RollerSettings& s) {
  const ParameterNode& p = plugin.parameters;
  s.wheel_base = p.number_of({"wheelbase", "wheel_base"}).value_or(1);
  s.separation = p.number_of({"wheel_separation", "wheelSeparation"}).value_or(1);
  const double lever = (s.wheel_base + s.separation) / 2;
  struct Corner {
    const char *name, *other;
    double aside, turn;
  };
  std::string missing;
  for (const Corner& corner :
       {Corner{"front_left_joint", "frontLeftJoint", -1, -1}, Corner{"front_right_joint", "frontRightJoint", 1, 1},
        Corner{"back_left_joint", "rear_left_joint", 1, -1}, Corner{"back_right_joint", "rear_right_joint", -1, 1}}) {
    std::vector<std::uint32_t> joints;
    add_joints(model, plugin, {corner.name, corner.other}, joints, missing);
    if (!missing.empty()) return drive_error(model, plugin, "the model has no joint " + base::in_quotes(missing));
    if (joints.empty())
      return drive_error(model, plugin,
                         fmt::format("it needs four wheels (front_left_joint, front_right_joint, back_left_joint, back_right_joint); "
                                     "there is no {}",
                                     corner.name));
    for (const auto joint : joints) s.wheels.push_back({joint, {1, corner.aside, corner.turn * lever}});
  }
  return {};
}

// Wheels that roll square to their axles, wherever they are: every joint that the plugin names.
base::Result<void> find_omni_wheels(const ModelDef& model, const PluginDef& plugin, RollerSettings& s) {
  std::vector<std::uint32_t> joints;
  for (const ParameterNode& child : plugin.parameters.children) {
    const auto joint = child.text.empty() ? std::nullopt : joint_of(model, plugin.scope, child.text);
    const bool is_named = child.name.ends_with("joint") || child.name.ends_with("Joint");
    if (is_named && !joint) return drive_error(model, plugin, "the model has no joint " + base::in_quotes(child.text));
    if (joint && std::find(joints.begin(), joints.end(), *joint) == joints.end()) joints.push_back(*joint);
  }
  if (joints.size() < 3)
    return drive_error(model, plugin, fmt::format("it needs three wheels or more (wheel_joint), got {}", joints.size()));
  double reach = 0;
  for (const auto joint : joints) {
    const JointDef& def = model.joints[joint];
    if (def.axes.empty()) return drive_error(model, plugin, fmt::format("joint {} does not turn", base::in_quotes(def.name)));
    const Eigen::Vector3d axle = def.pose_in_model.linear() * def.axes[0].xyz, place = wheel_place(model, joint);
    const Eigen::Vector3d rolling = axle.cross(Eigen::Vector3d::UnitZ());
    s.wheels.push_back({joint, {rolling.x(), rolling.y(), rolling.y() * place.x() - rolling.x() * place.y()}});
    reach += place.head<2>().norm() / static_cast<double>(joints.size());
  }
  s.separation = 2 * reach;
  return {};
}

Eigen::MatrixXd rows_of(const std::vector<RollerWheel>& wheels) {
  Eigen::MatrixXd rows(wheels.size(), 3);
  for (std::size_t i = 0; i < wheels.size(); ++i) rows.row(static_cast<Eigen::Index>(i)) = wheels[i].row;
  return rows;
}

base::Result<RollerSettings> roller_settings_of(const ModelDef& model, const PluginDef& plugin) {
  const ParameterNode& p = plugin.parameters;
  RollerSettings s;
  const auto find = kind_of(plugin) == PluginKind::mecanum_drive ? find_mecanum_wheels : find_omni_wheels;
  if (auto found = find(model, plugin, s); !found) return found.error();
  s.radius = p.number_of({"wheel_radius", "wheelRadius"}).value_or(wheel_radius(model, s.wheels[0].joint));
  if (const auto problem = size_problem("wheel radius", s.radius); !problem.empty()) return drive_error(model, plugin, problem);
  for (const auto& [what, size] : {std::pair("wheelbase", s.wheel_base), {"wheel separation", s.separation}}) {
    const bool is_given = kind_of(plugin) == PluginKind::mecanum_drive;
    if (const auto problem = size_problem(what, size); is_given && !problem.empty()) return drive_error(model, plugin, problem);
  }
  const Eigen::MatrixXd rows = rows_of(s.wheels);
  constexpr double least_share = 1e-3;  // of what the wheels can do in the direction that they can do best
  const Eigen::Vector3d strengths = Eigen::JacobiSVD<Eigen::MatrixXd>(rows).singularValues();
  if (!(strengths(2) > least_share * strengths(0)))
    return drive_error(model, plugin, "its wheels cannot drive in every direction and turn; wheel_separation and axles decide");
  for (const RollerWheel& wheel : s.wheels) s.torque = std::min(s.torque, torque_of(model, wheel.joint));
  s.max_speed = std::max(0.0, p.number_of({"max_linear_velocity", "max_velocity", "max_speed"}).value_or(0));
  s.max_yaw_rate = std::max(0.0, p.number_of({"max_angular_velocity", "max_yaw_rate"}).value_or(0));
  s.max_acceleration = std::max(0.0, p.number_of({"max_linear_acceleration", "max_acceleration"}).value_or(0));
  s.max_yaw_acceleration = std::max(0.0, p.number_of({"max_angular_acceleration", "max_yaw_acceleration"}).value_or(0));
  // In gz-sim one element limits both.
  if (is_of_gz_sim(plugin) && s.max_yaw_rate == 0) s.max_yaw_rate = std::max(0.0, p.number_of({"max_velocity"}).value_or(0));
  if (is_of_gz_sim(plugin) && s.max_yaw_acceleration == 0)
    s.max_yaw_acceleration = std::max(0.0, p.number_of({"max_acceleration"}).value_or(0));
  s.rate = std::max(0.0, p.number_of({"odom_publish_frequency", "update_rate"}).value_or(0));
  return s;
}

// Mecanum wheels without a direction of their friction are plain wheels: they cannot go sideways.
void warn_of_plain_wheels(const ModelDef& model, const PluginDef& plugin, const RollerSettings& s) {
  for (const RollerWheel& wheel : s.wheels) {
    const LinkDef* link = model.link(model.joints[wheel.joint].child);
    const auto is_plain = [](const CollisionDef& c) { return c.surface.mu == c.surface.mu2 || c.surface.friction_link.empty(); };
    if (link == nullptr || !std::any_of(link->collisions.begin(), link->collisions.end(), is_plain)) continue;
    base::log(base::Level::warn, model.name,
              "{}: plugin {}: wheel {} has no rollers: <mu2> 0 and <fdir1 gz:expressed_in=\"...\"> along the floor are expected; it does "
              "not roll sideways",
              plugin.source, plugin.name, base::in_quotes(link->name));
    return;
  }
}

class Rollers final : public DriveTrain {
 public:
  Rollers(Physics& physics, ModelId model, RollerSettings settings)
      : physics_(physics), model_(model), settings_(std::move(settings)), rows_(rows_of(settings_.wheels)) {
    back_ = (rows_.transpose() * rows_).inverse() * rows_.transpose();
    read_angles();
  }

  void describe(shm::Position2dInfo& info) const override {
    info.drive = RTMSIM_DRIVE_HOLONOMIC;
    info.max_speed = settings_.max_speed;
    info.max_yaw_rate = settings_.max_yaw_rate;
    info.max_acceleration = settings_.max_acceleration;
    info.max_yaw_acceleration = settings_.max_yaw_acceleration;
    info.wheel_separation = settings_.separation;
    info.wheel_radius = settings_.radius;
  }

  void drive(const DriveOrder& order, bool motors_on, double dt) override {
    Eigen::Vector3d asked(order.velocity[0], order.velocity[1], order.velocity[2]);
    limit(asked, settings_.max_speed > 0 ? settings_.max_speed : 1000, settings_.max_yaw_rate > 0 ? settings_.max_yaw_rate : 1000);
    Eigen::Vector3d change = asked - velocity_;
    limit(change, settings_.max_acceleration > 0 ? settings_.max_acceleration * dt : infinite,
          settings_.max_yaw_acceleration > 0 ? settings_.max_yaw_acceleration * dt : infinite);
    velocity_ = motors_on ? Eigen::Vector3d(velocity_ + change) : Eigen::Vector3d(0, 0, 0);
    for (const RollerWheel& wheel : settings_.wheels)
      physics_.set_motor({model_, wheel.joint}, 0, wheel.row.dot(velocity_) / settings_.radius, motors_on ? settings_.torque : 0);
  }

  Travel travel() override {
    Eigen::VectorXd rolled(rows_.rows()), speeds(rows_.rows());
    for (std::size_t i = 0; i < settings_.wheels.size(); ++i) {
      const JointState state = physics_.joint_state({model_, settings_.wheels[i].joint});
      const auto k = static_cast<Eigen::Index>(i);
      rolled[k] = settings_.radius * wrapped(state.position - angles_[i]);
      speeds[k] = settings_.radius * state.velocity;
      angles_[i] = state.position;
    }
    const Eigen::Vector3d way = back_ * rolled, rate = back_ * speeds;
    return {way[0], way[2], rate[0], rate[2], way[1], rate[1]};
  }

  std::array<double, 3> followed() const override { return {velocity_[0], velocity_[1], velocity_[2]}; }
  std::vector<std::uint32_t> joints() const override {
    std::vector<std::uint32_t> all;
    for (const RollerWheel& wheel : settings_.wheels) all.push_back(wheel.joint);
    return all;
  }
  double rate() const override { return settings_.rate; }
  void reset() override {
    velocity_.setZero();
    read_angles();
  }
  void add_to(StateHash& hash) const override { hash.add(velocity_); }

 private:
  // The direction stays, so that a robot that speeds up keeps to its line.
  static void limit(Eigen::Vector3d& velocity, double most, double max_turn) {
    const double speed = velocity.head<2>().norm();
    if (speed > most) velocity.head<2>() *= most / speed;
    velocity[2] = std::clamp(velocity[2], -max_turn, max_turn);
  }
  void read_angles() {
    angles_.clear();
    for (const RollerWheel& wheel : settings_.wheels) angles_.push_back(physics_.joint_state({model_, wheel.joint}).position);
  }

  Physics& physics_;
  ModelId model_;
  RollerSettings settings_;
  Eigen::MatrixXd rows_, back_;        // from velocities to rims, and back
  Eigen::Vector3d velocity_{0, 0, 0};  // that the motors follow
  std::vector<double> angles_;
};

}  // namespace

MadeTrain make_rollers(Physics& physics, ModelId model, const PluginDef& plugin) {
  auto settings = roller_settings_of(physics.def(model), plugin);
  if (!settings) return settings.error();
  if (kind_of(plugin) == PluginKind::mecanum_drive) warn_of_plain_wheels(physics.def(model), plugin, *settings);
  return std::unique_ptr<DriveTrain>(new Rollers(physics, model, std::move(*settings)));
}

}  // namespace sim

// Differential and skid drives: velocity commands become wheel speeds within the limits of speed, acceleration and torque.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "devices/angle.h"
#include "devices/drives/drive_train.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

struct PairSettings {
  bool is_skid = false;
  std::vector<std::uint32_t> left, right;  // joints
  double separation = 0;                   // between left and right wheels [m]
  double radius = 0;                       // of a wheel [m]
  double torque = 5;                       // of a wheel [N m]
  double max_speed = 0, max_yaw_rate = 0;  // 0: unlimited [m/s], [rad/s]
  double min_speed = 0, min_yaw_rate = 0;  // backward and to the right, negative; likewise
  double max_acceleration = 0;             // of a wheel's rim [m/s^2]; 0: unlimited
  double max_yaw_acceleration = 0;         // [rad/s^2]
  double rate = 0;                         // of samples [Hz]; 0: every step
};

// What the joints' own limits allow.
double torque_of_joints(const ModelDef& model, const std::vector<std::uint32_t>& left, const std::vector<std::uint32_t>& right) {
  double torque = strongest_torque;
  for (const auto* side : {&left, &right}) {
    for (const auto joint : *side) torque = std::min(torque, torque_of(model, joint));
  }
  return torque;
}

double wheel_separation(const ModelDef& model, std::uint32_t left, std::uint32_t right) {
  const Eigen::Vector3d between = wheel_place(model, left) - wheel_place(model, right);
  return between.head<2>().norm();
}

// Gazebo classic's own skid drive turns its wheels as told whatever it takes, too, and knows joints by these names without being told.
bool is_skid_of_classic(const PluginDef& plugin) {
  return base::to_lower(plugin.filename).find("skidsteerdriveplugin") != std::string::npos;
}

void add_joints_by_name(const ModelDef& model, const PluginDef& plugin, PairSettings& s) {
  for (const auto& [side, names] :
       {std::pair{&s.left, std::array{"left_front", "left_rear"}}, {&s.right, std::array{"right_front", "right_rear"}}}) {
    for (const char* name : names) {
      if (const auto joint = joint_of(model, plugin.scope, name)) side->push_back(*joint);
    }
  }
}

base::Result<PairSettings> pair_settings_of(const ModelDef& model, const PluginDef& plugin) {
  const ParameterNode& p = plugin.parameters;
  PairSettings s;
  s.is_skid = kind_of(plugin) == PluginKind::skid_steer_drive;
  std::string missing;
  add_joints(
      model, plugin,
      {"left_joint", "leftJoint", "left_front", "leftFrontJoint", "left_front_joint", "left_rear", "leftRearJoint", "left_rear_joint"},
      s.left, missing);
  add_joints(model, plugin,
             {"right_joint", "rightJoint", "right_front", "rightFrontJoint", "right_front_joint", "right_rear", "rightRearJoint",
              "right_rear_joint"},
             s.right, missing);
  if (!missing.empty()) return drive_error(model, plugin, "the model has no joint " + base::in_quotes(missing));
  if (s.left.empty() && s.right.empty() && is_skid_of_classic(plugin)) add_joints_by_name(model, plugin, s);
  if (s.left.empty() || s.right.empty()) return drive_error(model, plugin, "it needs a left and a right joint (left_joint, right_joint)");
  s.separation =
      p.number_of({"wheel_separation", "wheelSeparation", "wheel_track"}).value_or(wheel_separation(model, s.left[0], s.right[0]));
  s.radius = p.number_of({"wheel_radius", "wheelRadius"})
                 .value_or(p.number_of({"wheel_diameter", "wheelDiameter"}).value_or(2 * wheel_radius(model, s.left[0])) / 2);
  for (const auto& [what, size] : {std::pair("wheel separation", s.separation), {"wheel radius", s.radius}}) {
    if (const auto problem = size_problem(what, size); !problem.empty()) return drive_error(model, plugin, problem);
  }
  s.torque = p.number_of({"max_wheel_torque", "wheelTorque", "wheel_torque", "torque", "max_force", "MaxForce"})
                 .value_or(is_of_gz_sim(plugin) ? torque_of_joints(model, s.left, s.right) : s.torque);
  if (s.torque <= 0) s.torque = 5;
  if (is_skid_of_classic(plugin)) s.torque = strongest_torque;
  s.max_speed = std::max(0.0, p.number_of({"max_linear_velocity", "max_velocity", "max_speed", "maxSpeed"}).value_or(0));
  s.max_yaw_rate = std::max(0.0, p.number_of({"max_angular_velocity", "max_yaw_rate", "max_turnrate"}).value_or(0));
  // In gz-sim one element limits both.
  const auto both = [&](const char* element) { return is_of_gz_sim(plugin) ? p.number_of({element}).value_or(0) : 0; };
  if (s.max_yaw_rate == 0) s.max_yaw_rate = std::max(0.0, both("max_velocity"));
  s.min_speed = std::min(0.0, p.number_of({"min_linear_velocity", "min_velocity"}).value_or(-s.max_speed));
  s.min_yaw_rate = std::min(0.0, p.number_of({"min_angular_velocity"}).value_or(std::min(both("min_velocity"), 0.0)));
  if (s.min_yaw_rate == 0) s.min_yaw_rate = -s.max_yaw_rate;
  s.max_acceleration = std::max(
      0.0, p.number_of({"max_wheel_acceleration", "max_linear_acceleration", "max_acceleration", "wheelAcceleration", "wheel_acceleration"})
               .value_or(0));
  s.max_yaw_acceleration = std::max(0.0, p.number_of({"max_angular_acceleration", "max_yaw_acceleration"}).value_or(0));
  if (s.max_yaw_acceleration == 0) s.max_yaw_acceleration = std::max(0.0, both("max_acceleration"));
  s.rate = std::max(0.0, p.number_of({"odom_publish_frequency", "update_rate", "updateRate"}).value_or(0));
  return s;
}

class WheelPairs final : public DriveTrain {
 public:
  WheelPairs(Physics& physics, ModelId model, PairSettings settings) : physics_(physics), model_(model), settings_(std::move(settings)) {
    read_angles();
  }

  void describe(shm::Position2dInfo& info) const override {
    info.drive = settings_.is_skid ? RTMSIM_DRIVE_SKID : RTMSIM_DRIVE_DIFFERENTIAL;
    info.max_speed = settings_.max_speed;
    info.max_yaw_rate = settings_.max_yaw_rate;
    info.max_acceleration = settings_.max_acceleration;
    info.max_yaw_acceleration = settings_.max_yaw_acceleration;
    info.wheel_separation = settings_.separation;
    info.wheel_radius = settings_.radius;
  }

  void drive(const DriveOrder& order, bool motors_on, double dt) override {
    const auto limited = [](double value, double least, double most) {
      return std::clamp(value, least < 0 ? least : -1000.0, most > 0 ? most : 1000.0);
    };
    const double vx = limited(order.velocity[0], settings_.min_speed, settings_.max_speed),
                 va = limited(order.velocity[2], settings_.min_yaw_rate, settings_.max_yaw_rate);
    const double half = settings_.separation / 2;
    std::array<double, 2> change{vx - va * half - wheels_[0], vx + va * half - wheels_[1]};
    double share = 1;
    const double fastest_change = std::max(std::abs(change[0]), std::abs(change[1]));
    // Both wheels take the same share of their change, so that the robot keeps to its curve while it speeds up or brakes.
    if (settings_.max_acceleration > 0 && fastest_change > 0) share = std::min(share, settings_.max_acceleration * dt / fastest_change);
    const double turn_change = std::abs(change[1] - change[0]) / settings_.separation;
    if (settings_.max_yaw_acceleration > 0 && turn_change > 0) share = std::min(share, settings_.max_yaw_acceleration * dt / turn_change);
    for (std::size_t side = 0; side < 2; ++side) {
      wheels_[side] = motors_on ? wheels_[side] + share * change[side] : 0;
      for (const auto joint : side == 0 ? settings_.left : settings_.right) {
        physics_.set_motor({model_, joint}, 0, wheels_[side] / settings_.radius, motors_on ? settings_.torque : 0);
      }
    }
  }

  Travel travel() override {
    double left_rate = 0, right_rate = 0;
    const double left = settings_.radius * turned(settings_.left, left_angles_, left_rate);
    const double right = settings_.radius * turned(settings_.right, right_angles_, right_rate);
    return {(left + right) / 2, (right - left) / settings_.separation, settings_.radius * (left_rate + right_rate) / 2,
            settings_.radius * (right_rate - left_rate) / settings_.separation};
  }

  std::array<double, 3> followed() const override {
    return {(wheels_[0] + wheels_[1]) / 2, 0, (wheels_[1] - wheels_[0]) / settings_.separation};
  }
  std::vector<std::uint32_t> joints() const override {
    std::vector<std::uint32_t> all = settings_.left;
    all.insert(all.end(), settings_.right.begin(), settings_.right.end());
    return all;
  }
  double rate() const override { return settings_.rate; }
  void reset() override {
    wheels_ = {0, 0};
    read_angles();
  }
  void add_to(StateHash& hash) const override {
    for (const double wheel : wheels_) hash.add(wheel);
  }

 private:
  // Mean change of the angles of one side's wheels since the last call [rad].
  double turned(const std::vector<std::uint32_t>& joints, std::vector<double>& angles, double& rate) {
    double sum = 0;
    rate = 0;
    for (std::size_t i = 0; i < joints.size(); ++i) {
      const JointState state = physics_.joint_state({model_, joints[i]});
      sum += wrapped(state.position - angles[i]);
      angles[i] = state.position;
      rate += state.velocity;
    }
    rate /= static_cast<double>(joints.size());
    return sum / static_cast<double>(joints.size());
  }
  void read_angles() {
    left_angles_.clear();
    right_angles_.clear();
    for (const auto joint : settings_.left) left_angles_.push_back(physics_.joint_state({model_, joint}).position);
    for (const auto joint : settings_.right) right_angles_.push_back(physics_.joint_state({model_, joint}).position);
  }

  Physics& physics_;
  ModelId model_;
  PairSettings settings_;
  std::array<double, 2> wheels_{0, 0};  // speed of the rims that the motors follow now [m/s]: left, right
  std::vector<double> left_angles_, right_angles_;
};

}  // namespace

MadeTrain make_wheel_pairs(Physics& physics, ModelId model, const PluginDef& plugin) {
  auto settings = pair_settings_of(physics.def(model), plugin);
  if (!settings) return settings.error();
  return std::unique_ptr<DriveTrain>(new WheelPairs(physics, model, std::move(*settings)));
}

}  // namespace sim

// Cars: two wheels are steered so that all wheels roll about one centre, and every driven wheel turns as fast as its place on that circle
// asks. The point that vx and va are of is the middle between the rear wheels. A tricycle has one wheel in front that is driven and
// steered.
#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "devices/angle.h"
#include "devices/drives/drive_train.h"
#include "world/plugin_kind.h"

namespace sim {
namespace {

constexpr double slowest = 1e-3;   // [m/s] at which a yaw rate still tells a curve
constexpr double steer_rate = 10;  // [rad/s]

// Places in the model, from the middle between the rear wheels [m].
struct Wheel {
  std::uint32_t joint = 0;
  double x = 0, y = 0;
};

struct CarSettings {
  std::vector<Wheel> driven;
  std::vector<Wheel> steered;             // by their steering joints
  double wheel_base = 1, separation = 1;  // [m]
  double radius = 0;                      // of a driven wheel [m]
  double torque = strongest_torque;       // of a driven wheel [N m]
  double steering_limit = 0.5;            // [rad], as if one wheel in the middle were steered
  double steering_gain = 1;               // [1/s]: rate of the steering for each radian that is missing
  double max_speed = 0, min_speed = 0;    // forward; backward, negative; 0: unlimited [m/s]
  double max_acceleration = 0;            // 0: unlimited [m/s^2]
  double rate = 0;                        // of samples [Hz]; 0: every step
  double tightest = 1;                    // curve that a velocity can ask for [1/m]
  bool is_tricycle = false;               // one wheel in front is driven and steered
  bool is_steering_only = false;          // controllers of single joints turn the wheels
  std::vector<std::uint32_t> encoders;    // joints of its wheels in the rear, left and right, which its odometry comes from; or none
  double encoder_radius = 0;              // of those wheels [m]
};

Wheel place_of(const ModelDef& model, std::uint32_t joint) {
  const Eigen::Vector3d place = model.joints[joint].pose_in_model.translation();
  return {joint, place.x(), place.y()};
}

// Steering alone: no driven wheel says where the rear is.
void place_steering(const ParameterNode& p, CarSettings& s) {
  const auto aside = [](const Wheel& a, const Wheel& b) { return a.y < b.y; };
  const auto [right, left] = std::minmax_element(s.steered.begin(), s.steered.end(), aside);
  const double middle = (left->y + right->y) / 2;
  s.wheel_base = p.number_of({"wheel_base"}).value_or(1);
  s.separation = p.number_of({"wheel_separation"}).value_or(1);
  for (Wheel& wheel : s.steered) wheel.x = s.wheel_base, wheel.y -= middle;
}

// Wheels and steering joints, from the middle between the wheels in the rear.
base::Result<void> find_wheels(const ModelDef& model, const PluginDef& plugin, CarSettings& s) {
  std::vector<std::uint32_t> driven, steered;
  std::string missing;
  const bool is_of_ros = plugin.parameters.child("rear_left_joint") != nullptr;
  if (is_of_ros) {
    add_joints(model, plugin, {"rear_left_joint", "rear_right_joint"}, driven, missing);
  } else if (!s.is_steering_only) {
    add_joints(model, plugin, {"left_joint", "right_joint"}, driven, missing);
  }
  add_joints(model, plugin, {"left_steering_joint", "right_steering_joint"}, steered, missing);
  const auto error = [&](const std::string& what) { return drive_error(model, plugin, what); };
  if (!missing.empty()) return error("the model has no joint " + base::in_quotes(missing));
  if ((driven.empty() && !s.is_steering_only) || steered.empty()) {
    return error(fmt::format("it needs driven wheels ({}) and steering joints (left_steering_joint, right_steering_joint)",
                             is_of_ros ? "rear_left_joint, rear_right_joint" : "left_joint, right_joint"));
  }
  for (const auto joint : driven) s.driven.push_back(place_of(model, joint));
  for (const auto joint : steered) s.steered.push_back(place_of(model, joint));
  if (s.is_steering_only) return place_steering(plugin.parameters, s), base::Result<void>();
  const auto before = [](const Wheel& a, const Wheel& b) { return a.x < b.x; };
  const auto aside = [](const Wheel& a, const Wheel& b) { return a.y < b.y; };
  const double front = std::min_element(s.steered.begin(), s.steered.end(), before)->x;
  const auto rearmost = std::min_element(s.driven.begin(), s.driven.end(), before)->x;
  const auto [right, left] = std::minmax_element(s.driven.begin(), s.driven.end(), aside);
  // Where the wheels are decides the curve, not what the element says; many files keep its default of 1 m.
  s.wheel_base = front - rearmost;
  s.separation = left->y - right->y;
  const double middle = (left->y + right->y) / 2, rear = rearmost;
  for (auto* wheels : {&s.driven, &s.steered}) {
    for (Wheel& wheel : *wheels) wheel.x -= rear, wheel.y -= middle;
  }
  return {};
}

// The front wheel of a tricycle, from the middle between the wheels in the rear, which its encoders name; without any, from the model's
// origin, where robots of ROS have their base.
base::Result<void> find_tricycle(const ModelDef& model, const PluginDef& plugin, CarSettings& s) {
  std::vector<std::uint32_t> driven, steered, rear;
  std::string missing;
  add_joints(model, plugin, {"actuatedWheelJoint", "actuated_wheel_joint"}, driven, missing);
  add_joints(model, plugin, {"steeringJoint", "steering_joint"}, steered, missing);
  add_joints(model, plugin, {"encoderWheelLeftJoint", "encoder_wheel_left_joint"}, rear, missing);
  add_joints(model, plugin, {"encoderWheelRightJoint", "encoder_wheel_right_joint"}, rear, missing);
  const auto error = [&](const std::string& what) { return drive_error(model, plugin, what); };
  if (!missing.empty()) return error("the model has no joint " + base::in_quotes(missing));
  if (driven.size() != 1 || steered.size() != 1)
    return error("it needs one driven wheel and its steering (actuated_wheel_joint, steering_joint)");
  Eigen::Vector3d middle(0, 0, 0);
  for (const auto joint : rear) middle += wheel_place(model, joint) / static_cast<double>(rear.size());
  const ParameterNode& p = plugin.parameters;
  s.driven = {place_of(model, driven[0])};
  s.steered = {place_of(model, steered[0])};
  for (auto* wheel : {&s.driven[0], &s.steered[0]}) wheel->x -= middle.x(), wheel->y -= middle.y();
  s.driven[0].x = s.steered[0].x;  // it turns about the steering, wherever the file has put the joint
  s.wheel_base = s.steered[0].x;
  s.separation = rear.size() == 2 ? (wheel_place(model, rear[0]) - wheel_place(model, rear[1])).head<2>().norm()
                                  : p.number_of({"encoderWheelSeparation", "encoder_wheel_separation"}).value_or(s.wheel_base);
  s.is_tricycle = true;
  if (rear.size() == 2) {
    s.encoders = rear;
    s.encoder_radius = p.number_of({"encoderWheelDiameter", "encoder_wheel_diameter"}).value_or(2 * wheel_radius(model, rear[0])) / 2;
    if (const auto problem = size_problem("radius of an encoder's wheel", s.encoder_radius); !problem.empty()) return error(problem);
  }
  return {};
}

// What steers the one wheel of a tricycle: its joint has limits, or none within what makes sense.
double steering_range(const ModelDef& model, std::uint32_t joint) {
  constexpr double most = 1.5;  // [rad]
  const auto& axes = model.joints[joint].axes;
  if (axes.empty() || model.joints[joint].kind == JointDef::Kind::continuous) return most;
  const double range = std::min(-axes[0].lower, axes[0].upper);
  return range > 0 ? std::min(range, most) : most;
}

// Of ROS: without a word its wheel takes 5 N m.
void read_tricycle(const ModelDef& model, const ParameterNode& p, CarSettings& s) {
  s.torque = p.number_of({"wheelTorque", "max_wheel_torque"}).value_or(5);
  if (!(s.torque > 0)) s.torque = 5;
  s.steering_limit = steering_range(model, s.steered[0].joint);
  s.tightest = std::tan(s.steering_limit) / s.wheel_base;
  s.max_speed = std::max(0.0, p.number_of({"max_wheel_speed"}).value_or(0));
  s.min_speed = -s.max_speed;
  s.max_acceleration = std::max(0.0, p.number_of({"wheelAcceleration", "max_wheel_acceleration"}).value_or(0));
  s.rate = std::max(0.0, p.number_of({"updateRate", "update_rate"}).value_or(0));
}

base::Result<CarSettings> car_settings_of(const ModelDef& model, const PluginDef& plugin) {
  const ParameterNode& p = plugin.parameters;
  CarSettings s;
  const auto find = kind_of(plugin) == PluginKind::tricycle_drive ? find_tricycle : find_wheels;
  s.is_steering_only = is_steering_only(plugin);
  if (auto found = find(model, plugin, s); !found) return found.error();
  const double diameter = p.number_of({"actuatedWheelDiameter", "actuated_wheel_diameter", "wheelDiameter", "wheel_diameter"})
                              .value_or(s.is_steering_only ? 1 : 2 * wheel_radius(model, s.driven[0].joint));
  s.radius = p.number_of({"wheel_radius", "wheelRadius"}).value_or(diameter / 2);
  for (const auto& [what, size] : {std::pair("wheel base", s.wheel_base), {"wheel separation", s.separation}, {"wheel radius", s.radius}}) {
    if (const auto problem = size_problem(what, size); !problem.empty()) return drive_error(model, plugin, problem);
  }
  const bool is_of_gz = is_of_gz_sim(plugin);
  s.steering_limit = std::clamp(p.number_of({"steering_limit", "max_steer"}).value_or(is_of_gz ? 0.5 : 0.6), 0.01, 1.5);
  s.steering_gain = std::max(0.01, p.number_of({"steer_p_gain"}).value_or(is_of_gz ? 1 : steer_rate));
  for (const Wheel& wheel : s.driven) s.torque = std::min(s.torque, torque_of(model, wheel.joint));
  s.max_speed = std::max(0.0, p.number_of({"max_velocity", "max_speed"}).value_or(0));
  s.min_speed = std::min(0.0, p.number_of({"min_velocity"}).value_or(-s.max_speed));
  s.max_acceleration = std::max(0.0, p.number_of({"max_acceleration"}).value_or(0));
  s.rate = std::max(0.0, p.number_of({"odom_publish_frequency", "update_rate"}).value_or(0));
  s.tightest = std::sin(s.steering_limit) / s.wheel_base;
  if (s.is_tricycle) read_tricycle(model, p, s);
  return s;
}

class Car final : public DriveTrain {
 public:
  Car(Physics& physics, ModelId model, CarSettings settings) : physics_(physics), model_(model), settings_(std::move(settings)) {
    read_angles();
  }

  void describe(shm::Position2dInfo& info) const override {
    info.drive = RTMSIM_DRIVE_CAR;
    info.max_speed = settings_.max_speed;
    info.max_acceleration = settings_.max_acceleration;
    info.wheel_separation = settings_.separation;
    info.wheel_radius = settings_.radius;
    info.wheel_base = settings_.wheel_base;
    info.max_steering_angle = settings_.steering_limit;
  }

  void drive(const DriveOrder& order, bool motors_on, double dt) override {
    const double fastest = settings_.max_speed > 0 ? settings_.max_speed : 1000;
    double asked_vx = order.velocity[0];
    const double asked_va = order.velocity[2];
    if (order.steering) {
      curvature_ = std::tan(std::clamp(*order.steering, -settings_.steering_limit, settings_.steering_limit)) / settings_.wheel_base;
    } else if (std::abs(asked_vx) > slowest) {
      curvature_ = std::clamp(asked_va / asked_vx, -settings_.tightest, settings_.tightest);
    } else if (asked_va != 0) {
      curvature_ = std::copysign(settings_.tightest, asked_va);  // it cannot turn on the spot, but its wheels can
      if (settings_.is_tricycle) asked_vx = asked_va / curvature_;
    }
    const double vx = std::clamp(asked_vx, settings_.min_speed < 0 ? settings_.min_speed : -fastest, fastest);
    const double most = settings_.max_acceleration > 0 ? settings_.max_acceleration * dt : 1e9;
    speed_ = motors_on ? speed_ + std::clamp(vx - speed_, -most, most) : 0;
    steer(motors_on);
    const double curve = steered_curvature();
    for (const Wheel& wheel : settings_.driven) {
      physics_.set_motor({model_, wheel.joint}, 0, speed_ * share(wheel, curve) / settings_.radius, motors_on ? settings_.torque : 0);
    }
  }

  Travel travel() override {
    if (!settings_.encoders.empty()) return travel_of_encoders();
    if (settings_.driven.empty()) return {};
    const double curve = steered_curvature();
    double forward = 0, speed = 0;
    for (std::size_t i = 0; i < settings_.driven.size(); ++i) {
      const Wheel& wheel = settings_.driven[i];
      const JointState state = physics_.joint_state({model_, wheel.joint});
      forward += settings_.radius * wrapped(state.position - angles_[i]) / share(wheel, curve);
      speed += settings_.radius * state.velocity / share(wheel, curve);
      angles_[i] = state.position;
    }
    const auto count = static_cast<double>(settings_.driven.size());
    return {forward / count, forward / count * curve, speed / count, speed / count * curve};
  }

  // Of a steering alone nothing: others turn the wheels.
  std::array<double, 3> followed() const override {
    if (settings_.driven.empty()) return {0, 0, 0};
    return {speed_, 0, speed_ * curvature_};
  }
  std::vector<std::uint32_t> joints() const override {
    std::vector<std::uint32_t> all;
    for (const auto* wheels : {&settings_.driven, &settings_.steered}) {
      for (const Wheel& wheel : *wheels) all.push_back(wheel.joint);
    }
    return all;
  }
  double rate() const override { return settings_.rate; }
  void reset() override {
    speed_ = curvature_ = 0;
    read_angles();
  }
  void add_to(StateHash& hash) const override {
    for (const double value : {speed_, curvature_}) hash.add(value);
  }

 private:
  // How fast a wheel rolls, of the speed of the middle between the rear wheels, on a curve [1/m].
  static double share(const Wheel& wheel, double curve) {
    return std::max(std::hypot(1 - curve * wheel.y, curve * wheel.x), 0.05) * (curve * wheel.y > 1 ? -1 : 1);
  }

  void steer(bool motors_on) {
    for (const Wheel& wheel : settings_.steered) {
      const double angle = std::atan2(settings_.wheel_base * curvature_, 1 - curvature_ * wheel.y);
      const double missing = angle - physics_.joint_state({model_, wheel.joint}).position;
      const double rate = std::clamp(settings_.steering_gain * missing, -steer_rate, steer_rate);
      // Very little is not worth keeping a parked car awake for.
      const double torque = torque_of(physics_.def(model_), wheel.joint);
      physics_.set_motor({model_, wheel.joint}, 0, std::abs(missing) < 1e-4 ? 0 : rate, motors_on ? torque : 0);
    }
  }

  // Of a tricycle: what its wheels in the rear have rolled, also while the one in front slips.
  Travel travel_of_encoders() {
    std::array<double, 2> way{}, speed{};
    for (std::size_t i = 0; i < way.size(); ++i) {
      const JointState state = physics_.joint_state({model_, settings_.encoders[i]});
      way[i] = settings_.encoder_radius * wrapped(state.position - angles_[i]);
      speed[i] = settings_.encoder_radius * state.velocity;
      angles_[i] = state.position;
    }
    return {(way[0] + way[1]) / 2, (way[1] - way[0]) / settings_.separation, (speed[0] + speed[1]) / 2,
            (speed[1] - speed[0]) / settings_.separation};
  }

  // The curve that the wheels are steered to now [1/m].
  double steered_curvature() const {
    double sum = 0;
    for (const Wheel& wheel : settings_.steered) {
      const double slope = std::tan(std::clamp(physics_.joint_state({model_, wheel.joint}).position, -1.5, 1.5));
      sum += slope / (settings_.wheel_base + wheel.y * slope);
    }
    return sum / static_cast<double>(settings_.steered.size());
  }

  void read_angles() {
    angles_.clear();
    std::vector<std::uint32_t> joints = settings_.encoders;
    if (joints.empty()) {
      for (const Wheel& wheel : settings_.driven) joints.push_back(wheel.joint);
    }
    for (const auto joint : joints) angles_.push_back(physics_.joint_state({model_, joint}).position);
  }

  Physics& physics_;
  ModelId model_;
  CarSettings settings_;
  double speed_ = 0, curvature_ = 0;  // that the motors follow [m/s], [1/m]
  std::vector<double> angles_;        // of the wheels that the odometry comes from
};

}  // namespace

MadeTrain make_car(Physics& physics, ModelId model, const PluginDef& plugin) {
  auto settings = car_settings_of(physics.def(model), plugin);
  if (!settings) return settings.error();
  return std::unique_ptr<DriveTrain>(new Car(physics, model, std::move(*settings)));
}

}  // namespace sim

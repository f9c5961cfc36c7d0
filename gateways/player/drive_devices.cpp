#include "drive_devices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "protocol/payloads.h"

namespace gateway {
namespace {

constexpr std::uint8_t data_state = 1;

namespace commands {
constexpr std::uint8_t velocity = 1, pose = 2, car = 3, heading = 4;
}
namespace request2d {
constexpr std::uint8_t get_geometry = 1, motor_power = 2, velocity_mode = 3, position_mode = 4, set_odometry = 5, reset_odometry = 6,
                       speed_pid = 7, position_pid = 8, speed_profile = 9;
}
// The last two are the other way round than in position2d.
namespace request3d {
constexpr std::uint8_t get_geometry = 1, motor_power = 2, velocity_mode = 3, position_mode = 4, reset_odometry = 5, set_odometry = 6;
}

bool is_finite(std::initializer_list<double> values) {
  for (const double value : values) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

bool is_positive(double value) { return std::isfinite(value) && value > 0; }

template <class Info>
std::string geometry(const Info& info) {
  return player::encode_geometry(to_pose3d(info.pose), {.width = info.size[1], .length = info.size[0], .height = info.size[2]});
}

// The kind of the latest command is the mode; a request can only ask whether there is such a mode.
Answer choose_mode(const std::string& payload, bool has_mode) {
  const auto state = player::decode_u32(payload);
  return state && (has_mode || *state == 0) ? ack() : nack();
}

}  // namespace

Drive::~Drive() = default;

bool Drive::tell(Client& client, shm::CommandKind kind, std::span<const double> values) {
  if (!iface().command(kind, values)) return false;
  commanding_client_ = &client;
  return true;
}

void Drive::take_over(Client& client) {
  if (commanding_client_ != nullptr && iface().is_commanding()) {
    commanding_client_ = &client;
  } else {
    command_velocity(client, {});
  }
}

void Drive::forget(Client& client) {
  if (commanding_client_ != &client) return;
  commanding_client_ = nullptr;
  if (!source() || !iface().is_commanding()) return;  // somebody else drives
  // Fails when the simulator is gone, and the robot with it.
  static_cast<void>(iface().command(shm::CommandKind::velocity, {}));
}

std::optional<Answer> Drive::switch_motors(const std::string& payload, const Later& later) {
  const auto state = player::decode_byte(payload);
  if (!state) return nack();
  return ask(shm::SetMotorsRequest{iface().name(), *state != 0}, later);
}

// ---- position2d ----

void Position2d::show_sample() {
  const auto& sample = iface().sample<shm::Position2dSample>();
  player::Position2dState state;
  state.pose = {sample.odometry[0], sample.odometry[1], sample.odometry[2]};
  state.velocity = {sample.velocity[0], sample.velocity[1], sample.velocity[2]};
  state.is_stalled = sample.stalled != 0;
  publish(data_state, player::encode(state), sample.stamp);
  go_on(sample);
}

std::optional<Answer> Position2d::answer(std::uint8_t subtype, const std::string& payload, const Later& later) {
  switch (subtype) {
    case request2d::get_geometry:
      return ack(geometry(iface().info<shm::Position2dInfo>()));
    case request2d::motor_power:
      return switch_motors(payload, later);
    case request2d::velocity_mode:
      return choose_mode(payload, true);
    case request2d::position_mode:
      return choose_mode(payload, !is_car());
    case request2d::set_odometry: {
      const auto pose = player::decode_pose2d(payload);
      if (!pose || !is_finite({pose->x, pose->y, pose->a})) return nack();
      give_up();
      return ask(shm::ResetOdometryRequest{.iface = iface().name(), .x = pose->x, .y = pose->y, .a = pose->a}, later);
    }
    case request2d::reset_odometry:
      give_up();
      return ask(shm::ResetOdometryRequest{.iface = iface().name()}, later);
    case request2d::speed_pid:
    case request2d::position_pid: {  // the drive follows its velocities by itself: there is nothing to tune
      const auto gains = player::decode_pid(payload);
      return gains && is_finite({gains->p, gains->i, gains->d}) ? ack() : nack();
    }
    case request2d::speed_profile:
      return set_profile(payload) ? ack() : nack();
    default:
      return nack();
  }
}

void Position2d::obey(Client& client, std::uint8_t subtype, const std::string& payload) {
  if (subtype == commands::pose) return drive_to(client, payload);
  if (subtype == commands::heading) return keep_heading(client, payload);
  if (subtype == commands::car) return steer(client, payload);
  if (subtype != commands::velocity) return;
  const auto command = player::decode_velocity2d(payload);
  if (!command) return;
  const auto& wanted = command->velocity;
  if (command_velocity(client, command->is_enabled ? std::array{wanted.x, wanted.y, wanted.a} : std::array{0.0, 0.0, 0.0})) end_goal();
}

void Position2d::drive_to(Client& client, const std::string& payload) {
  const auto command = player::decode_pose_command2d(payload);
  if (!command || is_car()) return;
  const auto &pose = command->pose, &velocity = command->velocity;
  if (!is_finite({pose.x, pose.y, pose.a, velocity.x, velocity.y, velocity.a})) return;
  if (!command->is_enabled) {
    command_velocity(client, std::array{0.0, 0.0, 0.0});
    return end_goal();
  }
  take_over(client);
  const bool is_known = pursuer_ != nullptr && asked_ == payload && std::holds_alternative<shm::PoseControl>(goal_);
  pursuer_ = &client;
  if (is_known) return;  // many say it again and again
  goal_ = shm::PoseControl({pose.x, pose.y, pose.a}, limits(std::hypot(velocity.x, velocity.y), std::abs(velocity.a)));
  asked_ = payload;
}

void Position2d::keep_heading(Client& client, const std::string& payload) {
  const auto command = player::decode_heading_command(payload);
  constexpr double fastest = 1e9;  // that a command may be: the robot would go on as before, led by nobody
  if (!command || !(std::abs(command->speed) <= fastest) || !std::isfinite(command->angle)) return;
  take_over(client);
  pursuer_ = &client;
  goal_ = Heading{command->speed, command->angle};
}

// Speed and steering angle.
void Position2d::steer(Client& client, const std::string& payload) {
  const auto command = player::decode_heading_command(payload);  // the same two numbers
  if (!command || !is_car()) return;
  if (tell(client, shm::CommandKind::car, std::array{command->speed, command->angle})) end_goal();
}

void Position2d::go_on(const shm::Position2dSample& sample) {
  if (pursuer_ == nullptr) return;
  if (!iface().is_commanding()) return end_goal();  // somebody else drives now
  if (resets_.value_or(sample.stamp.resets) != sample.stamp.resets) return give_up();
  resets_ = sample.stamp.resets;
  const shm::PlanarPose odometry{sample.odometry[0], sample.odometry[1], sample.odometry[2]};
  shm::PlanarPose velocity;
  if (auto* way = std::get_if<shm::PoseControl>(&goal_)) {
    if (way->has_arrived()) return;
    velocity = way->next(odometry);
  } else if (const auto* heading = std::get_if<Heading>(&goal_)) {
    velocity = {heading->speed, 0, shm::turn_towards(odometry.a, heading->angle, limits(0, 0))};
  }
  command_velocity(*pursuer_, std::array{velocity.x, velocity.y, velocity.a});
}

void Position2d::end_goal() {
  pursuer_ = nullptr;
  goal_ = {};
  resets_.reset();
}

void Position2d::give_up() {
  if (pursuer_ == nullptr) return;
  if (iface().is_commanding()) command_velocity(*pursuer_, std::array{0.0, 0.0, 0.0});
  end_goal();
}

void Position2d::forget(Client& client) {
  if (pursuer_ == &client) end_goal();
  Drive::forget(client);
}

bool Position2d::is_car() const { return iface().info<shm::Position2dInfo>().drive == RTMSIM_DRIVE_CAR; }

shm::DriveLimits Position2d::limits(double speed, double turn) const {
  shm::DriveLimits wanted;
  wanted.speed = speed > 0 ? speed : speed_;
  wanted.turn = turn > 0 ? turn : turn_;
  wanted.acceleration = acceleration_;
  return shm::within(wanted, iface().info<shm::Position2dInfo>());
}

bool Position2d::set_profile(const std::string& payload) {
  const auto profile = player::decode_speed_profile(payload);
  if (!profile || !is_positive(profile->speed) || !is_positive(profile->acceleration)) return false;
  speed_ = profile->speed;
  acceleration_ = profile->acceleration;
  asked_.clear();
  return true;
}

std::optional<player::PropertyValue> Position2d::property(const std::string& key) const {
  if (key == "speed") return speed_;
  if (key == "turn") return turn_;
  if (key == "acceleration") return acceleration_;
  return Drive::property(key);
}

bool Position2d::set_property(const player::DriverProperty& wanted) {
  const auto* value = std::get_if<double>(&wanted.value);
  if (value == nullptr || !is_positive(*value)) return false;
  for (const auto& [key, place] : {std::pair("speed", &speed_), std::pair("turn", &turn_), std::pair("acceleration", &acceleration_)}) {
    if (wanted.key != key) continue;
    *place = *value;
    asked_.clear();
    return true;
  }
  return false;
}

// ---- position3d ----

void Position3d::show_sample() {
  const auto& sample = iface().sample<shm::Position3dSample>();
  const auto& v = sample.velocity;
  player::Position3dState state;
  state.pose = to_pose3d(sample.odometry);
  state.velocity = {v[0], v[1], v[2], v[3], v[4], v[5]};
  state.is_stalled = sample.stalled != 0;
  publish(data_state, player::encode(state), sample.stamp);
}

std::optional<Answer> Position3d::answer(std::uint8_t subtype, const std::string& payload, const Later& later) {
  switch (subtype) {
    case request3d::get_geometry:
      return ack(geometry(iface().info<shm::Position3dInfo>()));
    case request3d::motor_power:
      return switch_motors(payload, later);
    case request3d::velocity_mode:
    case request3d::position_mode:
      return choose_mode(payload, true);
    case request3d::set_odometry: {
      const auto pose = player::decode_pose3d(payload);
      if (!pose || !is_finite({pose->x, pose->y, pose->z, pose->roll, pose->pitch, pose->yaw})) return nack();
      give_up();
      return ask(shm::ResetOdometryRequest{.iface = iface().name(),
                                           .is_3d = true,
                                           .pose = shm::euler_pose(pose->x, pose->y, pose->z, pose->roll, pose->pitch, pose->yaw)},
                 later);
    }
    case request3d::reset_odometry:
      give_up();
      return ask(shm::ResetOdometryRequest{.iface = iface().name(), .is_3d = true}, later);
    default:
      return nack();
  }
}

void Position3d::obey(Client& client, std::uint8_t subtype, const std::string& payload) {
  if (subtype == commands::velocity) {
    const auto v = player::decode_velocity3d(payload);
    if (v && command_velocity(client, std::array{v->x, v->y, v->z, v->roll, v->pitch, v->yaw})) pursuer_ = nullptr;
  } else if (subtype == commands::pose) {
    // Client libraries never set the state of such a command: 0 is no "stop".
    const auto wanted = player::decode_pose_command3d(payload);
    if (!wanted) return;
    const auto& p = wanted->pose;
    if (tell(client, shm::CommandKind::pose, std::array{p.x, p.y, p.z, p.roll, p.pitch, p.yaw})) pursuer_ = &client;
  }
}

void Position3d::give_up() {
  if (pursuer_ != nullptr && iface().is_commanding()) command_velocity(*pursuer_, std::array<double, 6>{});
  pursuer_ = nullptr;
}

void Position3d::forget(Client& client) {
  if (pursuer_ == &client) pursuer_ = nullptr;
  Drive::forget(client);
}

}  // namespace gateway

#include "drive_devices.h"

#include <array>
#include <cmath>

#include "protocol/payloads.h"

namespace gateway {
namespace {

constexpr std::uint8_t data_state = 1, command_velocity_subtype = 1;

namespace request2d {
constexpr std::uint8_t get_geometry = 1, motor_power = 2, velocity_mode = 3, position_mode = 4, set_odometry = 5, reset_odometry = 6;
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

template <class Info>
std::string geometry(const Info& info) {
  return player::encode_geometry(to_pose3d(info.pose), {.width = info.size[1], .length = info.size[0], .height = info.size[2]});
}

// Drives follow velocities; the mode that they are in is the one that can be chosen.
Answer choose_mode(const std::string& payload, bool is_position_mode) {
  const auto state = player::decode_u32(payload);
  return state && !(is_position_mode && *state != 0) ? ack() : nack();
}

}  // namespace

Drive::~Drive() = default;

void Drive::command_velocity(Client& client, std::span<const double> values) {
  if (iface().command(shm::CommandKind::velocity, values)) commander_ = &client;
}

void Drive::forget(Client& client) {
  if (commander_ != &client) return;
  commander_ = nullptr;
  if (!source() || !iface().is_commander()) return;  // somebody else drives
  // Fails when the simulator is gone, and the robot with it.
  static_cast<void>(iface().command(shm::CommandKind::velocity, std::array<double, 6>{}));
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
}

std::optional<Answer> Position2d::answer(std::uint8_t subtype, const std::string& payload, const Later& later) {
  switch (subtype) {
    case request2d::get_geometry:
      return ack(geometry(iface().info<shm::Position2dInfo>()));
    case request2d::motor_power:
      return switch_motors(payload, later);
    case request2d::velocity_mode:
    case request2d::position_mode:
      return choose_mode(payload, subtype == request2d::position_mode);
    case request2d::set_odometry: {
      const auto pose = player::decode_pose2d(payload);
      if (!pose || !is_finite({pose->x, pose->y, pose->a})) return nack();
      return ask(shm::ResetOdometryRequest{.iface = iface().name(), .x = pose->x, .y = pose->y, .a = pose->a}, later);
    }
    case request2d::reset_odometry:
      return ask(shm::ResetOdometryRequest{.iface = iface().name()}, later);
    default:
      return nack();
  }
}

void Position2d::obey(Client& client, std::uint8_t subtype, const std::string& payload) {
  if (subtype != command_velocity_subtype) return;
  const auto command = player::decode_velocity2d(payload);
  if (!command) return;
  const auto& wanted = command->velocity;
  command_velocity(client, command->is_enabled ? std::array{wanted.x, wanted.y, wanted.a} : std::array{0.0, 0.0, 0.0});
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
      return choose_mode(payload, subtype == request3d::position_mode);
    case request3d::set_odometry: {
      const auto pose = player::decode_pose3d(payload);
      if (!pose || !is_finite({pose->x, pose->y, pose->z, pose->roll, pose->pitch, pose->yaw})) return nack();
      return ask(shm::ResetOdometryRequest{.iface = iface().name(),
                                           .is_3d = true,
                                           .pose = shm::euler_pose(pose->x, pose->y, pose->z, pose->roll, pose->pitch, pose->yaw)},
                 later);
    }
    case request3d::reset_odometry:
      return ask(shm::ResetOdometryRequest{.iface = iface().name(), .is_3d = true}, later);
    default:
      return nack();
  }
}

void Position3d::obey(Client& client, std::uint8_t subtype, const std::string& payload) {
  if (subtype != command_velocity_subtype) return;
  const auto v = player::decode_velocity3d(payload);
  if (v) command_velocity(client, std::array{v->x, v->y, v->z, v->roll, v->pitch, v->yaw});
}

}  // namespace gateway

// position2d and position3d: odometry out, velocities in. One thread at a time.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>

#include "device.h"
#include "shm/pose_control.h"

namespace gateway {

// The robot obeys the latest command; it stops when the client that gave it lets go of the device or vanishes.
class Drive : public Device {
 public:
  using Device::Device;
  ~Drive() override;

 protected:
  // False when the values can't be a command, or there is no simulator: then all stays as it was.
  bool command_velocity(Client& client, std::span<const double> values) { return tell(client, shm::CommandKind::velocity, values); }
  bool tell(Client& client, shm::CommandKind kind, std::span<const double> values);
  // From now on the robot follows this client. One that followed another client goes on as it was, any other stands.
  void take_over(Client& client);
  void forget(Client& client) override;
  std::optional<Answer> switch_motors(const std::string& payload, const Later& later);

 private:
  Client* commanding_client_ = nullptr;
};

// Also drives to poses of its odometry and keeps headings: one velocity per sample, as shm/pose_control.h says. That ends with any other
// command, also one from elsewhere; when the client lets go; and when the odometry is set or the world is reset, since the goal is no
// longer where it was. Cars, which can't turn on the spot, keep headings only; they alone
// take car-like commands.
class Position2d final : public Drive {
 public:
  using Drive::Drive;
  static constexpr std::array shows{shm::IfaceType::position2d};
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "odometry, velocity, stall"},
      {player::Type::request, 1, "geometry"},
      {player::Type::request, 2, "motors"},
      {player::Type::request, 3, "velocity and position mode"},
      {player::Type::request, 4, ""},
      {player::Type::request, 5, "set and reset odometry"},
      {player::Type::request, 6, ""},
      {player::Type::request, 9, "speed profile"},
      {player::Type::request, 7, "PID parameters without effect"},
      {player::Type::request, 8, ""},
      {player::Type::command, 1, "velocity"},
      {player::Type::command, 2, "pose"},
      {player::Type::command, 3, "car-like"},
      {player::Type::command, 4, "velocity with heading"},
  });

 private:
  ServedTable served() const override { return table; }
  struct Heading {
    double speed = 0, angle = 0;  // [m/s], [rad]
  };

  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
  void forget(Client& client) override;
  void on_attach() override { end_goal(); }
  std::optional<player::PropertyValue> property(const std::string& key) const override;
  bool set_property(const player::DriverProperty& wanted) override;

  bool is_car() const;
  void drive_to(Client& client, const std::string& payload);
  void keep_heading(Client& client, const std::string& payload);
  void steer(Client& client, const std::string& payload);
  void go_on(const shm::Position2dSample& sample);
  void end_goal();
  // Ends the goal, if there is one, and stops the robot.
  void give_up();
  bool set_profile(const std::string& payload);
  // Of a way with these speeds (0: as set), within what the robot can do.
  shm::DriveLimits limits(double speed, double turn) const;

  Client* pursuer_ = nullptr;  // who gave the goal; nothing without one
  std::variant<std::monostate, shm::PoseControl, Heading> goal_;
  std::string asked_;                    // the command that the goal was given by; empty: a new one would mean something else
  std::optional<std::uint32_t> resets_;  // of the world, when the goal was first pursued
  double speed_ = 0.4, turn_ = 1, acceleration_ = 0.5;  // of ways to a pose, unless a command says otherwise [m/s, rad/s, m/s^2]
};

// The drive itself flies to poses of its odometry, as fast as it can; that ends like the ways of a Position2d.
class Position3d final : public Drive {
 public:
  using Drive::Drive;
  static constexpr std::array shows{shm::IfaceType::position3d};
  // Resetting and setting the odometry are the other way round than in position2d.
  static constexpr std::array table = std::to_array<Served>({
      {player::Type::data, 1, "the same in 3D"},
      {player::Type::request, 1, "geometry"},
      {player::Type::request, 2, "motors"},
      {player::Type::request, 3, "modes"},
      {player::Type::request, 4, ""},
      {player::Type::request, 5, "set and reset odometry"},
      {player::Type::request, 6, ""},
      {player::Type::command, 1, "velocity"},
      {player::Type::command, 2, "pose"},
  });

 private:
  ServedTable served() const override { return table; }
  // Stops a robot that is on its way to a pose for a client: the pose would be elsewhere.
  void give_up();

  void show_sample() override;
  std::optional<Answer> answer(std::uint8_t subtype, const std::string& payload, const Later& later) override;
  void obey(Client& client, std::uint8_t subtype, const std::string& payload) override;
  void on_attach() override { pursuer_ = nullptr; }
  void forget(Client& client) override;

  Client* pursuer_ = nullptr;  // whose last command was a pose
};

}  // namespace gateway

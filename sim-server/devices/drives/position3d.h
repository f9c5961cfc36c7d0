// Robots that fly (or glide) by velocity commands, such as helicopters. The body follows vx vy vz and the yaw rate in its own, level frame
// within its limits of acceleration, keeps level and holds its height. Until the first command it falls, unless the file gives it an
// initial velocity. With way points (path.h) it flies along them while no client commands it; a model with way points and without a drive
// moves everything that it touches. See device.h for the thread rule.
//
// A body with way points is kinematic: its twist in each step leads exactly to the pose of the path at the end of the step. So it pushes
// other bodies, needs no forces, and is the same in every run. Of the trajectory plugin of gz-sim, which steers by forces, only the way
// points are used.
#pragma once

#include "devices/drives/drive.h"
#include "devices/drives/path.h"
#include "devices/sensors/sensor.h"

namespace sim {

// The velocity vx vy vz and yaw rate, in the level frame of a body at `pose`, that leads it to a place and yaw [rad]: as fast as allows to
// stop there with this acceleration.
Eigen::Vector4d velocity_towards(const Eigen::Isometry3d& pose, const Eigen::Vector3d& place, double yaw, double acceleration);
// Pose and velocity of the model as it is; the rest of the sample is the device's own.
void measure_body(const Physics& physics, ModelId model, const Eigen::Isometry3d& odometry_origin, shm::Position3dSample& out);

class Position3d final : public Sensor, public Drive {
 public:
  static MadeDevice make(DeviceWorld& world, ModelId model, const PluginDef& plugin, std::optional<Path> path);
  Position3d(Setup setup, const PluginDef& plugin, std::optional<Path> path);

  bool follows_steps() const override { return true; }
  void before_step(const Moment& moment) override;
  bool set_odometry(const Eigen::Isometry3d& pose) override;
  bool set_motors(bool enabled) override;
  bool is_working() const override { return !velocity_.isZero(); }
  void set_power(bool has_power) override;
  // Of its commands; the way points of a path are followed as they are.
  void set_fault(double strength, bool is_halted) override;

 private:
  void measure(const Moment& moment) const override;
  void restart() override;
  void begin();
  bool can_fly() const { return motors_enabled_ && has_power_; }
  void add_state_to(StateHash& hash) const override;
  Eigen::Vector4d to_goal(const Eigen::Isometry3d& pose) const;
  bool keep_to_path(const Moment& moment, const Eigen::Isometry3d& pose);
  void move(const Eigen::Isometry3d& pose, const Eigen::Vector3d& velocity, double yaw_rate);

  double max_speed_, max_yaw_rate_, max_acceleration_, max_yaw_acceleration_;
  Eigen::Vector4d initial_command_{0, 0, 0, 0};
  Eigen::Vector4d command_{0, 0, 0, 0};                                // vx vy vz, yaw rate
  Eigen::Vector4d velocity_{0, 0, 0, 0};                               // that it flies with now
  std::optional<Eigen::Vector4d> goal_;                                // x y z yaw in odometry, for position commands
  Eigen::Isometry3d odometry_origin_ = Eigen::Isometry3d::Identity();  // odometry = origin * true pose
  std::optional<Path> path_;
  double path_time_ = 0;  // how far along the path it is; stands still while it is off the path
  bool motors_enabled_ = true, has_power_ = true, is_commanded_ = false, is_kinematic_ = false;
  bool is_idle_ = false;  // nobody has commanded it yet
  double strength_ = 1;
  std::optional<Eigen::Vector4d> halted_at_;  // what was asked for then
};

}  // namespace sim

// Differential and skid drives: velocity commands become wheel speeds within the limits of speed, acceleration and torque; odometry comes
// from the wheels' encoders, the truth stands beside it. See device.h for the thread rule.
#pragma once

#include <array>

#include "devices/device.h"

namespace sim {

struct DriveSettings {
  bool is_skid = false;
  std::vector<std::uint32_t> left, right;  // joints
  double separation = 0;                   // between left and right wheels [m]
  double radius = 0;                       // of a wheel [m]
  double torque = 5;                       // of a wheel [N m]
  double max_speed = 0, max_yaw_rate = 0;  // 0: unlimited [m/s], [rad/s]
  double max_acceleration = 0;             // of a wheel's rim [m/s^2]; 0: unlimited
  double max_yaw_acceleration = 0;         // [rad/s^2]
  double rate = 0;                         // of samples [Hz]; 0: every step

  // From the plugin element, in the spellings in use; what is missing is taken from the model. Fails with a line.
  static base::Result<DriveSettings> of(const ModelDef& model, const PluginDef& plugin);
};

class Position2d final : public Device {
 public:
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, ModelId model, const PluginDef& plugin);

  shm::IfaceWriter& iface() override { return *writer_; }
  ModelId model() const override { return model_; }
  void before_step(const Moment& moment) override;
  void after_step(const Moment& moment) override;
  bool wants_sample(const Moment& moment) override;
  void measure(const Moment& moment) override;
  void publish(const Moment& moment) override;
  void reset() override;
  void add_to(StateHash& hash) const override;
  bool set_odometry(const Eigen::Isometry3d& pose) override;
  bool set_motors(bool enabled) override;

 private:
  Position2d(DeviceWorld& world, ModelId model, const DriveSettings& settings, std::unique_ptr<shm::IfaceWriter> writer);
  // Mean change of the angles of one side's wheels since the last call [rad].
  double turned(const std::vector<std::uint32_t>& joints, std::vector<double>& angles, double& rate);
  void read_angles();

  DeviceWorld& world_;
  ModelId model_;
  DriveSettings settings_;
  Schedule schedule_;
  std::unique_ptr<shm::IfaceWriter> writer_;

  std::array<double, 2> command_{0, 0};  // vx, va as asked for
  std::array<double, 2> wheels_{0, 0};   // speed of the rims that the motors follow now [m/s]: left, right
  std::vector<double> left_angles_, right_angles_;
  std::array<double, 3> odometry_{0, 0, 0};
  std::array<double, 2> velocity_{0, 0};
  bool motors_enabled_ = true, is_commanded_ = false;
  double stalled_for_ = 0;  // [s]
};

}  // namespace sim

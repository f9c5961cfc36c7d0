// Robots on wheels: velocity commands go to the drive train, and odometry comes from the wheels' encoders. The true pose is published
// beside it. See device.h for the thread rule.
#pragma once

#include <array>
#include <optional>

#include "devices/drives/drive.h"
#include "devices/drives/drive_train.h"
#include "devices/drives/traction.h"
#include "devices/sensors/sensor.h"

namespace sim {

class Position2d final : public Sensor, public Drive {
 public:
  static MadeDevice make(DeviceWorld& world, ModelId model, const PluginDef& plugin, std::unique_ptr<DriveTrain> train);
  Position2d(Setup setup, const Traction& traction, std::unique_ptr<DriveTrain> train, std::uint32_t drive);

  bool follows_steps() const override { return true; }
  void before_step(const Moment& moment) override;
  void after_step(const Moment& moment) override;
  bool set_odometry(const Eigen::Isometry3d& pose) override;
  bool set_motors(bool enabled) override;
  bool is_working() const override;
  void set_power(bool has_power) override { has_power_ = has_power; }
  // Out of order on purpose: follows this fraction of what is asked for; goes on as it was told last, whatever it is told.
  void set_fault(double strength, bool is_halted) override;

 private:
  void measure(const Moment& moment) const override;
  void restart() override;
  void add_state_to(StateHash& hash) const override;
  bool can_drive() const { return motors_enabled_ && has_power_; }
  DriveOrder order_of(const shm::Command& command) const;

  std::unique_ptr<DriveTrain> train_;
  DriveOrder command_;
  std::array<double, 3> odometry_{0, 0, 0}, velocity_{0, 0, 0};
  std::uint32_t drive_;  // RTMSIM_DRIVE_*
  bool motors_enabled_ = true, has_power_ = true, is_commanded_ = false;
  double strength_ = 1;
  std::optional<DriveOrder> halted_at_;  // the command then
  Traction traction_;
};

}  // namespace sim

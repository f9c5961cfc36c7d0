// A multicopter, boat or underwater vehicle, driven by its propellers: an iface position3d whose velocity the vehicle follows as far as its
// propellers can. Until the first command they do not turn, and the vehicle falls or floats. When a client detaches or commands a stop, the
// vehicle hovers or stays. Odometry is the true pose, from its own origin. See device.h for the thread rule.
#pragma once

#include "devices/drives/drive.h"
#include "devices/drives/vehicle_control.h"
#include "devices/sensors/sensor.h"

namespace sim {

class Vehicle3d final : public Sensor, public Drive {
 public:
  static MadeDevice make(DeviceWorld& world, ModelId model, const PluginDef& plugin, std::shared_ptr<Propellers> propellers,
                         std::unique_ptr<VehicleControl> control);
  Vehicle3d(Setup setup, std::shared_ptr<Propellers> propellers, std::unique_ptr<VehicleControl> control);

  bool follows_steps() const override { return true; }
  void before_step(const Moment& moment) override;
  bool set_odometry(const Eigen::Isometry3d& pose) override;
  bool set_motors(bool enabled) override;
  void set_fault(double strength, bool is_halted) override;
  bool is_working() const override { return !is_idle_ && motors_enabled_; }

 private:
  void measure(const Moment& moment) const override;
  void restart() override;
  void add_state_to(StateHash& hash) const override;
  void take(const Moment& moment);
  Vector6 wanted() const;

  std::shared_ptr<Propellers> propellers_;
  std::unique_ptr<VehicleControl> control_;
  Vector6 command_ = Vector6::Zero(), followed_ = Vector6::Zero();  // body frame
  std::optional<Eigen::Vector4d> goal_;                             // x y z yaw in odometry
  Eigen::Isometry3d odometry_origin_ = Eigen::Isometry3d::Identity();
  bool is_idle_ = true;  // nobody has commanded it yet
  bool motors_enabled_ = true, is_commanded_ = false;
  double strength_ = 1;
  std::optional<Vector6> halted_at_;  // what it followed then
};

}  // namespace sim

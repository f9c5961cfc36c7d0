// Robots on wheels: velocity commands go to the drive train; odometry comes from the wheels' encoders, the truth stands beside it. See
// device.h for the thread rule.
#pragma once

#include <array>

#include "devices/drive_train.h"

namespace sim {

class Position2d final : public Device {
 public:
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, ModelId model, const PluginDef& plugin,
                                                    std::unique_ptr<DriveTrain> train);

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
  Position2d(DeviceWorld& world, ModelId model, double separation, std::unique_ptr<DriveTrain> train,
             std::unique_ptr<shm::IfaceWriter> writer);

  DeviceWorld& world_;
  ModelId model_;
  double separation_;  // of the wheels [m]
  std::unique_ptr<DriveTrain> train_;
  Schedule schedule_;
  std::unique_ptr<shm::IfaceWriter> writer_;

  std::array<double, 2> command_{0, 0};  // vx, va as asked for
  std::array<double, 3> odometry_{0, 0, 0};
  std::array<double, 2> velocity_{0, 0};
  bool motors_enabled_ = true, is_commanded_ = false;
  double stalled_for_ = 0;  // [s]
};

}  // namespace sim

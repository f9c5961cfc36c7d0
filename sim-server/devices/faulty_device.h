// A device with faults that somebody has asked for: stands before the real one, which knows nothing of it. Without faults there is none of
// these. See device.h for the thread rule.
#pragma once

#include <memory>
#include <vector>

#include "devices/device.h"
#include "devices/sensor_fault.h"

namespace sim {

class Position2d;

class FaultyDevice final : public Device {
 public:
  // Fails when the device cannot have such a fault.
  static base::Result<std::unique_ptr<Device>> make(std::unique_ptr<Device> device, const std::vector<FaultOrder>& orders,
                                                    std::uint64_t seed);

  shm::IfaceWriter& iface() override { return device_->iface(); }
  ModelId model() const override { return device_->model(); }
  bool follows_steps() const override { return device_->follows_steps(); }
  void before_step(const Moment& moment) override;
  void after_step(const Moment& moment) override { device_->after_step(moment); }
  bool wants_sample(const Moment& moment) override;
  bool uses_rays() const override { return device_->uses_rays(); }
  void take_sample(const Moment& moment) override { device_->take_sample(moment); }
  void publish(const Moment& moment) override;
  bool owes_sample() override { return device_->owes_sample(); }
  void show(const Moment& moment) override { device_->show(moment); }
  void reset() override;
  void add_to(StateHash& hash) const override { device_->add_to(hash); }
  bool set_odometry(const Eigen::Isometry3d& pose) override { return device_->set_odometry(pose); }
  bool set_motors(bool enabled) override { return device_->set_motors(enabled); }

 private:
  explicit FaultyDevice(std::unique_ptr<Device> device) : device_(std::move(device)) {}

  std::unique_ptr<Device> device_;
  std::vector<SensorFault> sensor_faults_;
  std::vector<FaultOrder> drive_faults_;
  Position2d* drive_ = nullptr;  // the device, when it has faults of drives
  std::chrono::nanoseconds period_{0}, silent_until_{0};
};

}  // namespace sim

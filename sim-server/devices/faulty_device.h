// A device with injected faults. It wraps the real device, which is not changed. Devices without faults are not wrapped. See device.h for
// the thread rule.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "devices/device.h"
#include "devices/sensors/sensor_fault.h"

namespace sim {

class Drive;
class JointsDevice;
class Sensor;

class FaultyDevice final : public Device {
 public:
  FaultyDevice(std::unique_ptr<Device> device, std::uint64_t seed);

  // Fails when the device cannot have such a fault.
  base::Result<void> add(const FaultOrder& order);
  // The same in place of one of its kind, of the same iface or joint, that is on now. Those that have ended are forgotten.
  base::Result<void> replace(const FaultOrder& order, std::chrono::nanoseconds now);
  // Ends those that `which` is true of; how many there were.
  std::size_t end(const std::function<bool(const FaultOrder&)>& which);
  std::vector<FaultOrder> orders() const;

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
  void show(const Moment& moment) override;
  // Of faults that are added from now on.
  void set_seed(std::uint64_t seed) { seed_ = seed; }
  void reset() override;
  void add_to(StateHash& hash) const override { device_->add_to(hash); }
  bool set_odometry(const Eigen::Isometry3d& pose) override { return device_->set_odometry(pose); }
  bool set_motors(bool enabled) override { return device_->set_motors(enabled); }
  base::Result<void> write_tag(const std::string& id, const std::string& data) override { return device_->write_tag(id, data); }

 private:
  struct Entry {
    FaultOrder order;
    std::optional<SensorFault> fault;  // nothing: of a drive
    std::optional<std::size_t> joint;  // of a joints iface, this one alone
  };
  base::Result<std::optional<std::size_t>> joint_of(const FaultOrder& order);
  void weaken(const Moment& moment);
  std::unique_ptr<Device> device_;
  std::uint64_t seed_;
  std::vector<Entry> entries_;
  Drive* drive_;          // the device, when it is one
  JointsDevice* joints_;  // the same
  Sensor* sensor_;        // the same
};

}  // namespace sim

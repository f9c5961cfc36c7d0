// Sensors that read a few numbers off the world: the load of a joint, height and climb, the earth's magnetic field, the pressure of the
// air. See device.h for the thread rule.
#pragma once

#include <optional>
#include <vector>

#include "devices/device.h"
#include "rays/noise.h"

namespace sim {

class Meter final : public Device {
 public:
  // `joint` is the one that a force_torque sensor stands in; the mount of such a sensor is on the joint's child.
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::optional<JointId> joint);
  shm::IfaceWriter& iface() override { return *writer_; }
  ModelId model() const override { return mount_.link.model; }
  bool wants_sample(const Moment& moment) override { return schedule_.is_due(moment.time) && writer_->is_subscribed(); }
  void measure(const Moment& moment) override;
  void publish(const Moment& moment) override;
  void reset() override;
  void add_to(StateHash& hash) const override;

 private:
  Meter(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::optional<JointId> joint, double reference,
        std::unique_ptr<shm::IfaceWriter> writer);
  double noisy(std::size_t channel, double value);
  void measure_load();
  void measure_height();
  void measure_field();
  void measure_pressure();

  DeviceWorld& world_;
  Mount mount_;
  SensorKind kind_;
  std::optional<JointId> joint_;
  ForceTorqueDef load_;  // of a force_torque sensor
  double reference_;
  Schedule schedule_;
  std::vector<Noise> noise_, fresh_noise_;
  std::unique_ptr<shm::IfaceWriter> writer_;
};

// Of the standard atmosphere with the world's temperature [K] and pressure [Pa] at sea level.
double air_pressure_at(double altitude, double temperature, double pressure);

}  // namespace sim

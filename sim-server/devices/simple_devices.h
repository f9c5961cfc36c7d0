// The devices with little state of their own: sonar rings, imu, gps, bumper, and the true pose of a model. See device.h for the thread
// rule.
#pragma once

#include "devices/device.h"
#include "devices/ray_world.h"
#include "rays/noise.h"

namespace sim {

// One or more sonars of a model as one iface: each measures the nearest thing in its cone.
class SonarRing final : public Device {
 public:
  struct Transducer {
    Mount mount;
    const SensorDef* sensor;
  };
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, const std::string& name, const std::string& scope,
                                                    const std::vector<Transducer>& transducers);

  shm::IfaceWriter& iface() override { return *writer_; }
  ModelId model() const override { return mounts_.front().link.model; }
  bool wants_sample(const Moment& moment) override { return schedule_.is_due(moment.time) && writer_->is_subscribed(); }
  bool uses_rays() const override { return true; }
  void measure(const Moment& moment) override;
  void publish(const Moment& moment) override;
  void show(const Moment& moment) override;
  void reset() override;
  void add_to(StateHash& hash) const override;

 private:
  SonarRing(DeviceWorld& world, const std::vector<Transducer>& transducers, const shm::SonarInfo& info,
            std::unique_ptr<shm::IfaceWriter> writer);
  DeviceWorld& world_;
  std::vector<Mount> mounts_;
  std::vector<Beams> cones_;
  float min_range_, max_range_;
  Schedule schedule_;
  Noise noise_, fresh_noise_;
  std::unique_ptr<shm::IfaceWriter> writer_;
};

class Imu final : public Device {
 public:
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, Mount mount, const SensorDef& sensor);
  shm::IfaceWriter& iface() override { return *writer_; }
  ModelId model() const override { return mount_.link.model; }
  void after_step(const Moment& moment) override;
  bool wants_sample(const Moment& moment) override { return schedule_.is_due(moment.time) && writer_->is_subscribed(); }
  void measure(const Moment& moment) override;
  void publish(const Moment& moment) override;
  void show(const Moment& moment) override;
  void reset() override;
  void add_to(StateHash& hash) const override;

 private:
  Imu(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::unique_ptr<shm::IfaceWriter> writer);
  DeviceWorld& world_;
  Mount mount_;
  Schedule schedule_;
  std::array<Noise, 6> noise_, fresh_noise_;  // angular velocity x y z, acceleration x y z
  bool has_orientation_;
  Eigen::Matrix3d reference_;  // columns: axes of the frame that the orientation is told against, in the world
  Eigen::Vector3d velocity_{0, 0, 0}, acceleration_{0, 0, 0};
  bool has_velocity_ = false;
  std::unique_ptr<shm::IfaceWriter> writer_;
};

class Gps final : public Device {
 public:
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, Mount mount, const SensorDef& sensor);
  shm::IfaceWriter& iface() override { return *writer_; }
  ModelId model() const override { return mount_.link.model; }
  bool wants_sample(const Moment& moment) override { return schedule_.is_due(moment.time) && writer_->is_subscribed(); }
  void measure(const Moment& moment) override;
  void publish(const Moment& moment) override;
  void show(const Moment& moment) override;
  void reset() override;
  void add_to(StateHash& hash) const override;

 private:
  Gps(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::unique_ptr<shm::IfaceWriter> writer);
  DeviceWorld& world_;
  Mount mount_;
  Schedule schedule_;
  std::array<Noise, 4> noise_, fresh_noise_;  // position across, position up, velocity across, velocity up
  std::unique_ptr<shm::IfaceWriter> writer_;
};

// Latitude, longitude [degree] and altitude [m] of a point given in east, north, up [m] around a place, on the WGS 84 ellipsoid.
Eigen::Vector3d geodetic_of(const SphericalDef& place, const Eigen::Vector3d& east_north_up);

class Bumper final : public Device {
 public:
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, Mount mount, const SensorDef& sensor);
  shm::IfaceWriter& iface() override { return *writer_; }
  ModelId model() const override { return mount_.link.model; }
  bool wants_sample(const Moment& moment) override { return schedule_.is_due(moment.time) && writer_->is_subscribed(); }
  void measure(const Moment& moment) override;
  void publish(const Moment& moment) override;
  void reset() override;

 private:
  Bumper(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::unique_ptr<shm::IfaceWriter> writer);
  void record();
  DeviceWorld& world_;
  Mount mount_;
  std::vector<bool> collisions_;  // of the link: those that count
  Schedule schedule_;
  std::unique_ptr<shm::IfaceWriter> writer_;
};

class Truth final : public Device {
 public:
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, ModelId model);
  shm::IfaceWriter& iface() override { return *writer_; }
  ModelId model() const override { return model_; }
  bool wants_sample(const Moment&) override { return writer_->is_subscribed(); }
  void measure(const Moment& moment) override;
  void publish(const Moment& moment) override { writer_->publish(moment.time); }

 private:
  Truth(DeviceWorld& world, ModelId model, std::unique_ptr<shm::IfaceWriter> writer)
      : world_(world), model_(model), writer_(std::move(writer)) {}
  DeviceWorld& world_;
  ModelId model_;
  std::unique_ptr<shm::IfaceWriter> writer_;
};

}  // namespace sim

// Planar and layered range finders. See device.h for the thread rule.
#pragma once

#include "devices/device.h"
#include "devices/ray_world.h"
#include "rays/noise.h"

namespace sim {

class Laser final : public Device {
 public:
  static base::Result<std::unique_ptr<Device>> make(DeviceWorld& world, Mount mount, const SensorDef& sensor);

  shm::IfaceWriter& iface() override { return *writer_; }
  ModelId model() const override { return mount_.link.model; }
  bool wants_sample(const Moment& moment) override;
  bool uses_rays() const override { return true; }
  void measure(const Moment& moment) override;
  void publish(const Moment& moment) override;
  void show(const Moment& moment) override;
  void reset() override;
  void add_to(StateHash& hash) const override;

  // What it sees now, without noise, for pictures: the end points of the lowest layer's beams in the world, and where they start. Whether
  // or not anybody has subscribed; the rays must be up to date.
  std::vector<Eigen::Vector3d> look(Eigen::Vector3d& origin) const;

 private:
  Laser(DeviceWorld& world, Mount mount, const SensorDef& sensor, std::unique_ptr<shm::IfaceWriter> writer);

  DeviceWorld& world_;
  Mount mount_;
  RayDef ray_;
  Schedule schedule_;
  Beams beams_;
  Noise noise_, fresh_noise_;
  std::unique_ptr<shm::IfaceWriter> writer_;
};

}  // namespace sim

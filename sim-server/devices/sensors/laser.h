// Planar and layered range finders. See device.h for the thread rule.
#pragma once

#include "devices/ray_world.h"
#include "devices/sensors/sensor.h"

namespace sim {

class Laser final : public Sensor {
 public:
  Laser(Setup setup, const SensorSite& site);
  bool uses_rays() const override { return true; }

  // What it sees now, without noise, for pictures: the end points of the lowest layer's beams in the world, and where they start. Whether
  // or not anybody has subscribed; the rays must be up to date.
  std::vector<Eigen::Vector3d> look(Eigen::Vector3d& origin) const;

 private:
  void measure(const Moment& moment) const override;
  void add_state_to(StateHash& hash) const override { hash.add(writer().name()); }

  Mount mount_;
  RayDef ray_;
  Beams beams_;
};

}  // namespace sim

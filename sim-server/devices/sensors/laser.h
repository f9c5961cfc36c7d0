// Planar and layered range finders. See device.h for the thread rule.
#pragma once

#include <deque>
#include <vector>

#include "devices/ray_world.h"
#include "devices/sensors/sensor.h"

namespace sim {

class Laser final : public Sensor {
 public:
  Laser(Setup setup, const SensorSite& site);
  bool uses_rays() const override { return true; }
  bool follows_steps() const override { return ray_.is_rolling; }
  void after_step(const Moment& moment) override;

  // What it sees now, without noise, for pictures: the end points of the lowest layer's beams in the world, and where they start. Whether
  // or not anybody has subscribed; the rays must be up to date.
  std::vector<Eigen::Vector3d> look(Eigen::Vector3d& origin) const;

 private:
  void measure(const Moment& moment) const override;
  void add_state_to(StateHash& hash) const override { hash.add(writer().name()); }
  void restart() override { places_.clear(); }

  // A part of a rolling scan: some columns of all layers, seen from one place.
  struct Sector {
    std::size_t first = 0, count = 0;  // columns
    Beams beams;
  };
  struct Place {
    std::chrono::nanoseconds time;
    Eigen::Isometry3d pose;
  };
  void split();
  Eigen::Isometry3d place_at(std::chrono::nanoseconds time) const;
  void trace_rolling(const Moment& moment) const;

  Mount mount_;
  RayDef ray_;
  Beams beams_;
  std::chrono::nanoseconds sweep_{0};  // of a rolling scan
  std::vector<Sector> sectors_;
  std::deque<Place> places_;  // of the last sweep, in the world; see docs/worlds.md
};

}  // namespace sim

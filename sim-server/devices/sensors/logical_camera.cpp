#include <cmath>

#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

constexpr std::uint32_t logical_capacity = 256;

// The frame of each model and nested model, in the order of the world, that of its own model too.
template <class Take>
void each_model(const Physics& physics, Take take) {
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id)) continue;
    const ModelDef& def = physics.def(id);
    take(def.name, physics.model_pose(id));
    for (const NestedDef& nested : def.nested) take(def.name + "::" + nested.name, physics.link_pose({id, nested.link}) * nested.pose);
  }
}

class LogicalCamera final : public Sensor {
 public:
  LogicalCamera(Setup setup, const SensorSite& site)
      : Sensor(std::move(setup)), mount_(site.mount), frustum_(std::get<LogicalCameraDef>(site.def.data)) {}

 private:
  void measure(const Moment&) const override {
    const Eigen::Isometry3d pose = mount_.in_world(physics()), back = pose.inverse();
    const auto room = followers<shm::SeenModel>(0);
    auto& out = sample<shm::LogicalCameraSample>();
    out.pose = to_pose(pose);
    out.count = out.total = 0;
    each_model(physics(), [&](const std::string& name, const Eigen::Isometry3d& model) {
      const Eigen::Isometry3d seen = back * model;
      if (!is_inside(seen.translation())) return;
      ++out.total;
      if (out.count >= room.size()) return;
      shm::SeenModel& one = room[out.count++];
      shm::set_text(one.name, name);
      one.pose = to_pose(seen);
    });
  }

  bool is_inside(const Eigen::Vector3d& point) const {
    const double half_width = point.x() * std::tan(frustum_.horizontal_fov / 2);
    return point.x() >= frustum_.near_clip && point.x() <= frustum_.far_clip && std::abs(point.y()) <= half_width &&
           std::abs(point.z()) <= half_width / frustum_.aspect_ratio;
  }

  Mount mount_;
  LogicalCameraDef frustum_;
};

}  // namespace

MadeDevice make_logical_camera(const SensorSite& site) {
  const auto& def = std::get<LogicalCameraDef>(site.def.data);
  auto info = info_of<shm::LogicalCameraInfo>(site);
  info.capacity = logical_capacity;
  info.near_clip = def.near_clip;
  info.far_clip = def.far_clip;
  info.hfov = def.horizontal_fov;
  info.aspect_ratio = def.aspect_ratio;
  return make_sensor<LogicalCamera>(site, shm::iface_spec(shm::IfaceType::logical_camera, site.iface(), info), {});
}

}  // namespace sim

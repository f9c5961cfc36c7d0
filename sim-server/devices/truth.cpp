#include "devices/simple_devices.h"

namespace sim {

base::Result<std::unique_ptr<Device>> Truth::make(DeviceWorld& world, ModelId model) {
  const ModelDef& def = world.physics.def(model);
  shm::TruthInfo info{};
  shm::set_text(info.model, def.name);
  auto writer = world.shm.create(shm::truth_spec(def.name, info));
  if (!writer) return writer.error();
  return std::unique_ptr<Device>(new Truth(world, model, std::move(*writer)));
}

void Truth::measure(const Moment&) {
  auto& sample = writer_->sample<shm::TruthSample>();
  const Eigen::Isometry3d pose = world_.physics.model_pose(model_);
  const LinkId link = world_.physics.canonical_link(model_);
  const Eigen::Vector3d v = world_.physics.point_velocity(link, pose.translation()), w = world_.physics.link_twist(link).angular;
  sample.pose = to_pose(pose);
  for (int i = 0; i < 3; ++i) sample.velocity[i] = v[i], sample.velocity[i + 3] = w[i];
}

}  // namespace sim

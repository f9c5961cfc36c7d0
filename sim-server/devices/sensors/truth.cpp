#include "devices/sensors/truth.h"

namespace sim {
namespace {

class Truth final : public Sensor {
 public:
  explicit Truth(Setup setup) : Sensor(std::move(setup)) {}

 private:
  void measure(const Moment&) const override {
    auto& out = sample<shm::TruthSample>();
    const Eigen::Isometry3d pose = physics().model_pose(model());
    const LinkId link = physics().canonical_link(model());
    const Eigen::Vector3d v = physics().point_velocity(link, pose.translation()), w = physics().link_twist(link).angular;
    out.pose = to_pose(pose);
    for (int i = 0; i < 3; ++i) out.velocity[i] = v[i], out.velocity[i + 3] = w[i];
  }
};

}  // namespace

MadeDevice make_truth(DeviceWorld& world, ModelId model) {
  const ModelDef& def = world.physics.def(model);
  shm::TruthInfo info{};
  shm::set_text(info.model, def.name);
  auto setup = set_up(world, model, 0, shm::iface_spec(shm::IfaceType::truth, def.name, info), {});
  if (!setup) return setup.error();
  return MadeDevice(std::make_unique<Truth>(std::move(*setup)));
}

}  // namespace sim

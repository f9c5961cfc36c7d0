#include "devices/sensors/sensor_makers.h"

namespace sim {
namespace {

// The load of the joint that it stands in.
class ForceTorque final : public Sensor {
 public:
  ForceTorque(Setup setup, const SensorSite& site)
      : Sensor(std::move(setup)), mount_(site.mount), joint_(*site.joint), def_(std::get<ForceTorqueDef>(site.def.data)) {}

 private:
  void measure(const Moment&) const override {
    const Wrench load = physics().joint_load(joint_).value_or(Wrench{});
    const double sense = def_.measures_parent_to_child ? 1 : -1;
    const Eigen::Isometry3d sensor = mount_.in_world(physics());
    const Eigen::Vector3d torque = load.torque + (load.place - sensor.translation()).cross(load.force);
    const Eigen::Matrix3d to_axes = axes(sensor).transpose();
    const Eigen::Vector3d f = sense * (to_axes * load.force), t = sense * (to_axes * torque);
    auto& out = sample<shm::ForceTorqueSample>();
    for (std::size_t i = 0; i < 3; ++i) {
      out.force[i] = noisy(i, f[static_cast<Eigen::Index>(i)]);
      out.torque[i] = noisy(i + 3, t[static_cast<Eigen::Index>(i)]);
    }
  }

  // In the world, of the frame that it tells its numbers in.
  Eigen::Matrix3d axes(const Eigen::Isometry3d& sensor) const {
    if (def_.frame == ForceTorqueDef::Frame::sensor) return sensor.linear();
    const ModelDef& model = physics().def(joint_.model);
    const JointDef& joint = model.joints[joint_.joint];
    const auto link = link_of(model, {}, def_.frame == ForceTorqueDef::Frame::parent ? joint.parent : joint.child);
    if (!link) return Eigen::Matrix3d::Identity();
    return physics().link_pose({joint_.model, *link}).linear();
  }

  Mount mount_;
  JointId joint_;
  ForceTorqueDef def_;
};

}  // namespace

MadeDevice make_force_torque(const SensorSite& site) {
  const auto& def = std::get<ForceTorqueDef>(site.def.data);
  auto info = info_of<shm::MeterInfo>(site);
  info.noise[0] = stated_deviation(def.force.front());
  info.noise[1] = stated_deviation(def.torque.back());
  shm::set_text(info.joint, site.model().joints[site.joint->joint].name);
  std::vector<NoiseDef> noises(def.force.begin(), def.force.end());
  noises.insert(noises.end(), def.torque.begin(), def.torque.end());
  return make_sensor<ForceTorque>(site, shm::iface_spec(shm::IfaceType::force_torque, site.iface(), info), noises);
}

}  // namespace sim

#include "devices/device.h"

#include <cmath>

#include "world/body_force_defs.h"

namespace sim {

Schedule::Schedule(double rate) {
  if (rate > 0) period_ = std::chrono::nanoseconds(std::max<std::int64_t>(1, std::llround(1e9 / rate)));
}

void Schedule::done(std::chrono::nanoseconds now) {
  next_ = period_.count() > 0 ? (now / period_ + 1) * period_ : std::chrono::nanoseconds(0);
}

base::Result<void> Device::write_tag(const std::string&, const std::string&) {
  return base::Error{iface().name() + " is no reader of RFID tags"};
}

shm::Pose to_pose(const Eigen::Isometry3d& pose) {
  const Eigen::Quaterniond q(pose.linear());
  const Eigen::Vector3d p = pose.translation();
  return {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
}

Eigen::Isometry3d from_pose(const shm::Pose& pose) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.translation() = Eigen::Vector3d(pose.x, pose.y, pose.z);
  result.linear() = Eigen::Quaterniond(pose.qw, pose.qx, pose.qy, pose.qz).normalized().toRotationMatrix();
  return result;
}

double yaw_of(const Eigen::Isometry3d& pose) { return std::atan2(pose.linear()(1, 0), pose.linear()(0, 0)); }

std::string scoped_model(const ModelDef& model, const std::string& scope) { return scope.empty() ? model.name : model.name + "::" + scope; }

std::optional<std::uint32_t> link_of(const ModelDef& model, const std::string& scope, const std::string& name) {
  return link_named(model, scope, name);
}
std::optional<std::uint32_t> joint_of(const ModelDef& model, const std::string& scope, const std::string& name) {
  return joint_named(model, scope, name);
}

}  // namespace sim

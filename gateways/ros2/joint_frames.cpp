#include "joint_frames.h"

#include <cmath>

#include "ros/from_iface.h"

namespace ros2 {

shm::Pose motion_of(const shm::Joint& joint, double position) {
  const double* a = joint.axis;
  if (joint.kind == RTMSIM_JOINT_SLIDES) return {a[0] * position, a[1] * position, a[2] * position, 1, 0, 0, 0};
  const double s = std::sin(position / 2);
  return {0, 0, 0, std::cos(position / 2), a[0] * s, a[1] * s, a[2] * s};
}

shm::Pose joint_frame(std::span<const shm::Joint> joints, std::size_t i, const std::function<double(const shm::Joint&)>& position_of) {
  const auto moved = [&](const shm::Joint& joint) {
    return position_of ? ros::product(joint.pose, motion_of(joint, position_of(joint))) : joint.pose;
  };
  shm::Pose pose = moved(joints[i]);
  std::size_t parent = joints[i].parent;
  for (std::size_t steps = 0; parent != 0 && parent <= joints.size() && steps < joints.size(); ++steps) {
    pose = ros::product(moved(joints[parent - 1]), pose);
    parent = joints[parent - 1].parent;
  }
  return pose;
}

std::string carrier_of(const ListedModel& model, std::string link, const std::function<bool(const std::string&)>& moves) {
  for (std::size_t i = 0; i <= model.links.size(); ++i) {  // a ring of fixed joints has an end, too
    if (moves(link)) return link;
    const auto parent = model.fixed_to.find(link);
    if (parent == model.fixed_to.end()) return "";
    link = parent->second;
  }
  return "";
}

}  // namespace ros2

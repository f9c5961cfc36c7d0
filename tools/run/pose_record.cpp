#include "run/pose_record.h"

#include <cmath>

namespace tools {

bool PoseRecord::take(double time) {
  is_over_ = is_over_ || time < last || time > end_;
  if (!is_over_) last = time;
  return !is_over_;
}

void PoseRecord::add_pose(const std::string& model, const RecordedPose& pose) {
  if (take(pose.time)) poses[model].push_back(pose);
}

void PoseRecord::add_joint(const std::string& name, const RecordedJoint& joint) {
  if (take(joint.time)) joints[name].push_back(joint);
}

void PoseRecord::add_contact(const RecordedContact& contact) {
  if (!is_over_ && contact.time <= end_) contacts.push_back(contact);
}

void PoseRecord::add_still(double time) { take(time); }

double path_length(const std::vector<RecordedPose>& poses) {
  double length = 0;
  for (std::size_t i = 1; i < poses.size(); ++i)
    length += std::hypot(poses[i].x - poses[i - 1].x, poses[i].y - poses[i - 1].y, poses[i].z - poses[i - 1].z);
  return length;
}

}  // namespace tools

#include "devices/drives/body.h"

namespace sim {

void describe_body(const ModelDef& model, shm::Pose& middle, double (&size)[3]) {
  middle = shm::identity_pose;
  const Eigen::AlignedBox3d box = box_of(model, Eigen::Isometry3d::Identity());
  if (box.isEmpty()) return;
  middle.x = box.center().x();
  middle.y = box.center().y();
  middle.z = box.center().z();
  for (int i = 0; i < 3; ++i) size[i] = box.sizes()[i];
}

}  // namespace sim

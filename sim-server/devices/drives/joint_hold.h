// Joints that a controller plugin would hold or turn: they keep the position or the speed that the plugin starts with, since no client
// commands them. So arms do not fall. The stepping thread only.
#pragma once

#include <string>
#include <vector>

#include "physics/physics.h"

namespace sim {

struct JointHold {
  JointId joint;
  bool has_target = true, turns = false;
  double target = 0;    // [rad] or [m]
  double velocity = 0;  // without a target [rad/s] or [m/s]
  double most = 10;     // of the velocity towards the target [rad/s] or [m/s]
  double effort = 0;    // [N m] or [N]

  void before_step(Physics& physics) const;
};

// Of all controller plugins of the model. What they name and the model does not have adds a line.
std::vector<JointHold> joint_holds_of(const Physics& physics, ModelId model, std::vector<std::string>& left_out);

}  // namespace sim

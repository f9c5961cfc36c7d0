// Groups the joints of a model as users command them: an array, the fingers of its grippers, a chain to a tip, a pan and a tilt below a
// camera. Only joints with an actuator: their effort has a limit, or a controller names them. Pure; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "world/world_def.h"

namespace sim {

struct JointGroup {
  std::string kind;  // array, gripper, chain, pan_tilt
  std::string name;  // of a gripper
  std::vector<std::string> joints;
  double field_of_view = 0;  // of the camera on a pan and a tilt [rad]
};

// `commandable`: the joints of the model's iface, in its order.
std::vector<JointGroup> joint_groups(const ModelDef& model, const std::vector<std::uint32_t>& commandable);

}  // namespace sim

// The joints of a model that can be commanded, and the gains and limits of their controllers: from the controller plugins of the file and
// the YAML files beside it, otherwise derived from the masses that each joint moves. Pure; any thread.
#pragma once

#include <string>
#include <vector>

#include "physics/joint_control.h"
#include "physics/joint_dynamics.h"
#include "world/world_def.h"

namespace sim {

struct ListedJoint {
  std::uint32_t joint = 0;  // index into ModelDef::joints
  JointServo::Setup setup;
  std::string gains_from;
  int leader = -1;        // its number in the list, of a joint that follows another one and takes no commands
  double multiplier = 1;  // of the leader's rate
};

// Joints with one axis that no drive of the model turns, in the order of the file.
std::vector<std::uint32_t> commandable_joints(const ModelDef& model);

// The plugin is a drive or a propeller that turns this joint.
bool drives_joint(const ModelDef& model, const PluginDef& plugin, std::uint32_t joint);

// The dynamics are those of the same joints. `gravity`: [m/s^2].
std::vector<ListedJoint> list_joints(const ModelDef& model, const std::vector<std::uint32_t>& joints, const JointDynamics& dynamics,
                                     double gravity);

}  // namespace sim

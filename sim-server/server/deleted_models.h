// Models that were deleted, as they were at that time: `spawn deleted://NAME` restores the newest of that name, with its pose, joints and
// velocities. Drives stop and odometry begins at zero. The stepping thread only.
#pragma once

#include <string_view>
#include <vector>

#include "physics/physics.h"

namespace sim {

class DeletedModels {
 public:
  // Before it is removed. The oldest of more than 32 is forgotten.
  void keep(const Physics& physics, ModelId model);
  // nullptr: none was deleted, or it was forgotten. Valid until the next keep() or clear().
  const ModelDef* find(std::string_view name) const;
  void clear() { models_.clear(); }

 private:
  std::vector<ModelDef> models_;  // the oldest first
};

}  // namespace sim

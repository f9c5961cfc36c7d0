// The joints of a model. One thread at a time.
#pragma once

#include <Eigen/Geometry>
#include <pugixml.hpp>
#include <string>

#include "world/complaints.h"
#include "world/sdf_library.h"
#include "world/world_def.h"

namespace sim {

// The name of a part of a model that stands in the scope of a nested one; the scope is empty for the model itself.
inline std::string scoped(const std::string& scope, const std::string& name) { return scope.empty() ? name : scope + "::" + name; }

// All of it but its sensors. `place`: where the model of that scope is in the whole model, whose links are there already.
JointDef build_joint(pugi::xml_node node, const ResolvedJoint& frames, const std::string& scope, const Eigen::Isometry3d& place,
                     const ModelDef& model, Complaints& complaints);

}  // namespace sim

// Mass, centre of mass and inertia of links from <inertial> [kg, m, kg m^2]. Impossible numbers are corrected, with a finding. One thread
// at a time.
#pragma once

#include <string>

#include "world/model_builder.h"

namespace sim {

void build_inertial(LinkDef& link, pugi::xml_node inertial, bool is_static, BuildContext& context);
// From the volumes of the collisions; as it was, with a finding, when there is nothing to weigh.
void take_automatic_inertia(LinkDef& link, pugi::xml_node inertial, BuildContext& context);
// Positive definite and possible for a body of positive density; `why` says what was wrong.
Eigen::Matrix3d repaired_inertia(const Eigen::Matrix3d& inertia, double mass, std::string& why);

}  // namespace sim

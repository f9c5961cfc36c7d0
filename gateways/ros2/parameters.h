// The parameter services of a node. It has one parameter: use_sim_time, which is true and cannot be set. One thread at a time.
#pragma once

#include "node.h"

namespace ros2 {

// `node` is the name under which the services stand, for a node that shows several.
void serve_parameters(Node& node, const NodeName& name);

}  // namespace ros2

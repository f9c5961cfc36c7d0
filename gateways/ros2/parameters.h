// The log of a node of ROS 2, the events of its parameters and the services of its parameters. There is one parameter:
// use_sim_time, which cannot be changed. One thread at a time.
#pragma once

#include "node.h"

namespace ros2 {

struct NodeParameters {
  bool are_served = true;
  bool is_sim_time = true;  // the value of use_sim_time
};

// The writer of /rosout, which the node owns; nothing when DDS has no room.
Writer* complete_node(Node& node, const NodeParameters& parameters);

}  // namespace ros2

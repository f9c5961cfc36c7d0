// The bodies of a model as a tree that its joints make, for TreeSolver. Private to physics/. Values; one thread at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "physics/joints.h"

namespace sim {

struct JointTree {
  struct Place {
    std::uint32_t assembly = 0;
    int parent = -1;        // place of the body that it hangs on; -1: the world, or nothing
    int joint = -1;         // by which it does, index into the model's joints; -1: it hangs on nothing
    bool is_child = false;  // it is the child of that joint
  };
  std::vector<Place> places;  // parents come before what hangs on them; empty unless is_one
  bool is_one = false;        // false: joints make a loop, or are of a kind that TreeSolver does not know
};

// `bodies` by assembly; those that nothing moves have none.
JointTree joint_tree(const std::vector<ode::Body>& bodies, const std::vector<JointInstance>& joints);

}  // namespace sim

// Rotates bodies without contacts and joints by Euler's equations. ODE's gyroscopic torque takes 5 % of the energy of a tumbling plate in
// ten seconds. Here its angular momentum is constant, and its energy to 1e-6. Private to physics/; the stepping thread of the shard.
#pragma once

#include <vector>

#include "physics/ode.h"

namespace sim {

class FreeRotation {
 public:
  // Before a step, for each awake body of it, after its contacts were made. Bodies that turn about an axis of inertia, or not at all, cost
  // a comparison and stay ODE's.
  void add(dBodyID body);
  // After the step of `dt` [s]: what ODE has done to the speed (torques, damping) is kept, its turn is replaced.
  void finish(double dt);

 private:
  struct Turning {
    dBodyID body;
    Eigen::Quaterniond orientation;  // before the step
  };
  std::vector<Turning> turning_;
};

}  // namespace sim

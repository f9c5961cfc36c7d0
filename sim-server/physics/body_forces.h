// Forces of water and air on the bodies of a model before each step: wind, buoyancy, damping and added mass, lift and drag. Private to
// physics/. The stepping thread of the shard.
//
// Added mass is not a mass for ODE, whose bodies have one number for all directions. Its force is that of the acceleration which the forces
// of the last step give a body with both masses. If the forces change, the missing part of the water's momentum is applied in the next
// step. So the step is stable for any added mass, and the body moves as one of both masses from the second step on.
#pragma once

#include <vector>

#include "physics/aerodynamics.h"
#include "physics/blueprint.h"
#include "physics/displacement.h"
#include "physics/hash.h"
#include "physics/ode.h"
#include "physics/shapes.h"
#include "physics/wind.h"
#include "world/body_force_defs.h"

namespace sim {

class JointInstance;

class BodyForces {
 public:
  // The bodies are those of the assemblies. Collisions without a known volume add a line to `lost` where a fluid carries the model.
  BodyForces(const Blueprint& blueprint, const PhysicsDef& physics, ShapeStore& shapes, std::vector<std::string>& lost);

  bool is_empty() const {
    return !has_wind_ && floats_.empty() && waters_.empty() && wings_.empty() && airframes_.empty() && airships_.empty() && hulls_.empty();
  }
  // Water or air carries it: it never rests but where it touches something.
  bool carries() const {
    return !floats_.empty() || !waters_.empty() || !wings_.empty() || !airframes_.empty() || !airships_.empty() || !hulls_.empty();
  }
  // By a wind that was still changing in the last step: it does not rest.
  bool is_blown() const { return is_blown_; }
  void apply(const std::vector<ode::Body>& bodies, const std::vector<JointInstance>& joints, const PhysicsDef& physics, const Air& air);

  // What added mass remembers of the last step.
  struct Memory {
    Vector6 velocity = Vector6::Zero(), effort = Vector6::Zero(), debt = Vector6::Zero();
    bool has_velocity = false;
  };
  const std::vector<Memory>& memories() const { return memories_; }
  void remember(const std::vector<Memory>& memories) { memories_ = memories; }
  // Its bodies were put somewhere, or were given velocities.
  void forget() { memories_.assign(memories_.size(), {}); }
  void add_to(StateHash& hash) const;

 private:
  struct Float {
    std::uint32_t assembly = 0;
    Displacement shape;
    Eigen::Isometry3d in_body;
  };
  struct Water {
    std::uint32_t assembly = 0;
    HydrodynamicsDef def;
    Eigen::Isometry3d in_body;  // the link
    double mass = 1;            // of the body
    Eigen::Vector3d inertia{1, 1, 1};
    Matrix6 own = Matrix6::Identity();      // mass of the body
    Matrix6 of_both = Matrix6::Identity();  // inverse of that and the added mass
    bool has_added = false;
  };
  // A plugin's own description, and the body that it means.
  template <class Def>
  struct OnBody {
    std::uint32_t assembly = 0;
    Def def;
    Eigen::Isometry3d in_body;
  };

  void add_floats(ShapeStore& shapes, std::vector<std::string>& lost);
  void add_waters();
  void blow(const std::vector<ode::Body>& bodies, const Air& air) const;
  static void lift(const Float& one, dBodyID body, const FluidDef& fluid, const Eigen::Vector3d& gravity);
  static void damp(const Water& water, Memory& memory, dBodyID body, double dt);
  static Vector6 drag_along(const Water& water, Memory& memory, const Vector6& velocity, double dt);
  void fly_all(const std::vector<ode::Body>& bodies, const std::vector<JointInstance>& joints, const Eigen::Vector3d& wind) const;
  static void fly(const OnBody<WingDef>& wing, dBodyID body, double control, const Eigen::Vector3d& wind);

  const Blueprint& blueprint_;
  bool has_wind_ = false, is_blown_ = false;
  std::vector<Float> floats_;
  std::vector<Water> waters_;
  std::vector<Memory> memories_;  // of waters_
  std::vector<OnBody<WingDef>> wings_;
  std::vector<OnBody<AirframeDef>> airframes_;
  std::vector<OnBody<AirshipDef>> airships_;
  std::vector<OnBody<FloatingHullDef>> hulls_;
};

}  // namespace sim

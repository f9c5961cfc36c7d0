// What the simulator is measured against: Embree and ODE used by hand for one purpose each, with nothing around them. They are made from
// the same definitions as the simulator's own world. One thread at a time.
#pragma once

#include <memory>
#include <span>

#include "world/triangles.h"
#include "world/world_def.h"

namespace sim::bench {

// All static shapes of a world but planes in one flat scene of the highest quality, traced in coherent packets of 16.
class BareRays {
 public:
  BareRays(const WorldDef& world, TriangleCache& triangles);
  ~BareRays();
  // A fan in the plane of the sensor; ranges in m, infinite where nothing is nearer than `far`.
  void aim(int beams, double from, double to, float far);
  void trace(const Eigen::Isometry3d& sensor, std::span<float> ranges) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// All models of a world in one ODE world, stepped exactly; static shapes in a quad-tree space. Boxes, spheres, cylinders and planes only.
class BareSteps {
 public:
  explicit BareSteps(const WorldDef& world);
  ~BareSteps();
  // The wheels of all robots: rad/s of their left and right hinges.
  void drive(double left, double right);
  void step();
  // Of the first body of the n-th model that moves.
  Eigen::Isometry3d pose(std::size_t robot) const;
  std::size_t robots() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace sim::bench

// Records the poses of moving models ten times a simulated second, and the steps in which two models begin to touch. The stepping thread
// only.
#pragma once

#include <chrono>
#include <set>
#include <utility>
#include <vector>

#include "devices/device.h"
#include "physics/physics.h"

namespace sim {

// What a watch reports to: a file, or the pose log of a client. Times are seconds.
class PoseSink {
 public:
  virtual ~PoseSink() = default;
  virtual void contact(double time, ModelId model, ModelId other, const Physics& physics) = 0;
  virtual void pose(double time, ModelId model, const Physics& physics) = 0;
  // No model moves.
  virtual void still(double time) = 0;
  virtual void end_of_moment() {}
};

class PoseWatch {
 public:
  PoseWatch() : schedule_(10) {}
  // After each step.
  void look(std::chrono::nanoseconds time, const Physics& physics, const std::vector<PoseSink*>& sinks);
  // After a reset of the world.
  void restart() {
    schedule_.restart();
    touching_.clear();
  }

 private:
  void look_at_contacts(double time, const Physics& physics, const std::vector<PoseSink*>& sinks);
  Schedule schedule_;
  std::set<std::pair<ModelId, ModelId>> touching_;  // in the last step; the smaller id first
};

}  // namespace sim

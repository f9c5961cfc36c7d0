// The pose log that a client reads (shm/pose_log.h). The stepping thread only.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "server/pose_watch.h"
#include "shm/pose_log.h"

namespace sim {

class MemoryLog final : public PoseSink {
 public:
  void contact(double time, ModelId model, ModelId other, const Physics& physics) override;
  void pose(double time, ModelId model, const Physics& physics) override;
  void still(double time) override;
  shm::PoseLogWriter& bytes() { return bytes_; }
  // MODEL::JOINT each; what is not in the world (yet) has no positions.
  void watch_joints(const std::vector<std::string>& names) { joints_ = {names.begin(), names.end()}; }

 private:
  std::set<std::string, std::less<>> joints_;
  shm::PoseLogWriter bytes_;
};

}  // namespace sim

// The pose log that a client reads (shm/pose_log.h). The stepping thread only.
#pragma once

#include "server/pose_watch.h"
#include "shm/pose_log.h"

namespace sim {

class MemoryLog final : public PoseSink {
 public:
  void contact(double time, ModelId model, ModelId other, const Physics& physics) override;
  void pose(double time, ModelId model, const Physics& physics) override;
  void still(double time) override;
  shm::PoseLogWriter& bytes() { return bytes_; }

 private:
  shm::PoseLogWriter bytes_;
};

}  // namespace sim

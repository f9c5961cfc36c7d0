// Writes the poses of moving models as text: one line per model and tenth of a simulated second.
// The stepping thread only.
//   # rtm-sim record 1, world NAME
//   # time model x y z qw qx qy qz      (s, m, unit quaternion; world frame)
//   0.100 pioneer2dx 0 0 0 1 0 0 0
// If no model moves, a comment line has the time, so that a reader sees the progress:
//   # 0.200 nothing moves
// and one line, in the step in which it happens, when two models begin to touch:
//   contact 3.217 pioneer2dx box_4
#pragma once

#include <fstream>
#include <string>
#include <utility>

#include "base/result.h"
#include "server/pose_watch.h"

namespace sim {

class Recorder final : public PoseSink {
 public:
  static base::Result<Recorder> open(const std::string& path, const std::string& world);
  void contact(double time, ModelId model, ModelId other, const Physics& physics) override;
  void pose(double time, ModelId model, const Physics& physics) override;
  void still(double time) override;
  // When the disk is full it says so once and stops.
  void end_of_moment() override;
  // Writes what is left. False when something could not be written.
  bool finish();

 private:
  Recorder(std::string path, std::ofstream file) : path_(std::move(path)), file_(std::move(file)) {}
  std::string path_;
  std::ofstream file_;
};

}  // namespace sim

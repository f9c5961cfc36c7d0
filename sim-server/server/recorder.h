// Writes where every moving model was, as text: one line per model and tenth of a simulated second.
// The stepping thread only.
//   # rtm-sim record 1, world NAME
//   # time model x y z qw qx qy qz      (s, m, unit quaternion; world frame)
//   0.100 pioneer2dx 0 0 0 1 0 0 0
// when no model moves, a line that says so, as who reads along sees how far it is:
//   # 0.200 nothing moves
// and one line, in the step in which it happens, when two models begin to touch:
//   contact 3.217 pioneer2dx box_4
#pragma once

#include <chrono>
#include <fstream>
#include <set>
#include <string>
#include <utility>

#include "base/result.h"
#include "devices/device.h"
#include "physics/physics.h"

namespace sim {

class Recorder {
 public:
  static base::Result<Recorder> open(const std::string& path, const std::string& world);
  // After each step. When the disk is full it says so once and stops.
  void record(std::chrono::nanoseconds time, const Physics& physics);
  // Writes what is left. False when something could not be written.
  bool finish();
  void restart() {
    schedule_.restart();
    touching_.clear();
  }

 private:
  void record_contacts(double seconds, const Physics& physics);
  Recorder(std::string path, std::ofstream file) : path_(std::move(path)), file_(std::move(file)), schedule_(10) {}
  std::string path_;
  std::ofstream file_;
  Schedule schedule_;
  std::set<std::pair<ModelId, ModelId>> touching_;  // in the last step; the smaller id first
};

}  // namespace sim

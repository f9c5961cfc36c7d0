// Models that were added to, or deleted from, a recorded world after its start: `/sim/shapes` at a given time, in addition to the initial
// scene. One thread at a time.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "studio/client_message.h"
#include "studio/recorded_scene.h"

namespace studio {

class LateModels {
 public:
  // The first message (visualization_msgs/msg/MarkerArray) of the recording: which models had shapes at the beginning.
  void begin(const Json& markers);
  // The one that holds at the moment that is shown.
  void take(const Json& markers, const RecordedScene& scene);
  // Frames of the links of those that have come, in their order: behind the links of the scene.
  const std::vector<std::string>& frames() const { return frames_; }
  // {"op":"late", "version", "models":[{name, links:[{name, parts:[{color, points}]}]}], "gone":[name]}
  Json event(const RecordedScene& scene) const;

 private:
  std::set<std::string> first_;  // names of models
  std::vector<std::string> frames_;
  Json models_ = Json::array(), gone_ = Json::array();
};

}  // namespace studio

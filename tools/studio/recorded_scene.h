// The scene of a recording: the glTF of the recorded world, exported by a simulator that exits again, and the poses of links from the
// recorded frames. The scene is a value for any thread; poses belong to one thread at a time.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/result.h"
#include "studio/client_message.h"
#include "studio/web.h"

namespace studio {

// x y z [m] and the quaternion w x y z.
using PoseNumbers = std::array<float, 7>;

struct RecordedScene {
  Content glb, glb_with_collisions;
  std::uint32_t version = 0;
  Json models = Json::array();     // as in the event "world"
  std::vector<std::string> links;  // their frames, "model::link", in the order of the scene
  std::vector<PoseNumbers> poses;  // of links, as the scene has them

  // Starts a simulator of the recorded world, for a moment. An error is one line: the recording has no world, or it cannot be loaded.
  static base::Result<std::shared_ptr<const RecordedScene>> make(const std::string& recording);
  // Of a glTF; its links, models and version.
  static base::Result<RecordedScene> read(Content glb);
};

// Frames with their parents, as /tf and /tf_static tell of them.
class RecordedPlaces {
 public:
  // A message of tf2_msgs/msg/TFMessage.
  void take(const Json& message);
  // Seven numbers for each link of the scene, and then for each of these frames; links that nobody tells of stay as the scene has them.
  std::vector<float> of(const RecordedScene& scene, const std::vector<std::string>& more = {}) const;

 private:
  struct Frame {
    std::string parent;
    PoseNumbers pose{};
  };
  bool is_placed(const std::string& name, PoseNumbers& pose) const;
  std::map<std::string, Frame> frames_;
};

}  // namespace studio

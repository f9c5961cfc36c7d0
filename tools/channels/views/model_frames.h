// The models of a simulator with their links and joints: names and poses. Asks the simulator, for at most three seconds. One thread at a
// time.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "ros/messages.h"
#include "shm/layout.h"
#include "shm/request_board.h"

namespace channels {

struct ModelFrames {
  struct Link {
    std::string frame;  // "model::link"
    shm::Pose pose;     // on the model
  };
  struct Axis {
    std::string name;       // of the joint; "joint/2" of its second axis
    std::size_t joint = 0;  // of the model
    std::size_t number = 0;
  };
  std::string name;
  bool is_static = false;
  shm::Pose pose;  // in the world
  std::vector<Link> links;
  std::vector<Axis> axes;  // of joints that have a position
  std::size_t joints = 0;
  bool is_rigid = false;  // its links never move on it
};

// What the links of all models do on them.
class Limbs {
 public:
  explicit Limbs(std::uint32_t server_id) : server_id_(server_id) {}

  // Which models there are; again after some have come or gone.
  base::Result<void> learn();
  const std::vector<ModelFrames>& models() const { return models_; }
  bool has_moving() const;
  // Where they are now; also within a tick. False when models have come or gone since learn(), or nobody answers.
  bool read();
  // Of models whose links move on them; `places`: where the models are in the world, by name. Of actors all, in the world.
  void add_transforms(const shm::Stamp& stamp, const std::map<std::string, shm::Pose>& places,
                      std::vector<ros::TransformStamped>& transforms) const;
  // Of a model by its place; positions [rad or m] and velocities of its axes.
  ros::JointState joints_of(std::size_t model, const shm::Stamp& stamp) const;

 private:
  const std::uint32_t server_id_;
  std::optional<shm::Requester> simulator_;
  std::vector<ModelFrames> models_;
  double version_ = -1;  // of the simulator's scene
  std::size_t link_count_ = 0, joint_count_ = 0;
  bool has_actors_ = false;
  std::vector<std::string> actor_frames_;  // each actor's, and those of its bones
  std::vector<float> links_, joints_;      // seven of each, four of each
};

}  // namespace channels

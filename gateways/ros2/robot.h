// One robot of a world as a node: its ifaces on topics, its commands, its frames. One thread at a time.
//
// An iface is read, and so simulated, only while a topic of it has a subscriber.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "commands.h"
#include "naming.h"
#include "node.h"
#include "ros/from_iface.h"
#include "world.h"

namespace ros2 {

// What the robots of a world share.
struct Shared {
  Participant& participant;
  Graph& graph;
  World& world;
  const Naming& naming;
  Writer* tf = nullptr;  // "/tf"; nothing when each robot has its own
  std::chrono::nanoseconds command_timeout{0};
  Commands::OnArrival on_arrival{};
  bool has_joint_tf = true;  // false: robot_state_publisher sends the frames of links
};

// An iface and its topics.
struct Outlet {
  std::shared_ptr<Source> source;
  std::vector<Writer*> writers;
  // Publishes the latest sample or frame; null where the iface has samples.
  std::function<void(shm::Iface&, const shm::HeldFrame*)> show;
  std::chrono::nanoseconds period{0};  // at most one sample per period of simulated time; 0: all
  std::int64_t last_ns = -1;
  bool is_read = false;
  bool is_first = false;  // moves frames: shown before the others
  bool is_wanted() const;
};

class Robot {
 public:
  Robot(Shared& shared, std::string model, const Listed& listed);
  ~Robot();

  const std::string& model() const { return model_; }
  // The simulator has removed an iface of it.
  bool is_gone() const;
  // What it serves, for people and for comparisons: "scan", "odom", ...
  std::vector<std::string> topics() const;
  // Starts and ends the reading of ifaces; true when something has changed.
  bool choose_sources();
  // Reads what is new; shows it. The frames of robots go first, so there are two calls: with true, then with false.
  void read();
  void show(bool is_first);
  std::vector<ros::TransformStamped> static_transforms() const { return static_transforms_; }
  // On the robot's own topic, when it has one.
  void send_static_transforms();
  Commands& commands() { return commands_; }
  Node& node() { return node_; }
  std::vector<Outlet>& outlets() { return outlets_; }
  // By iface: the types that it can have topics of.
  const std::map<std::string, std::vector<std::string>>& types() const { return types_; }

 private:
  friend class RobotTopics;
  // "/tf", or "/leader/tf".
  Writer* tf();

  Shared& shared_;
  const std::string model_;
  const RobotNames names_;
  Node node_;
  Commands commands_;
  std::vector<Outlet> outlets_;
  std::vector<ros::TransformStamped> static_transforms_;
  std::vector<Outlet*> fresh_;
  std::set<std::string> used_topics_;
  std::map<std::string, std::vector<std::string>> types_;
  Writer* own_tf_ = nullptr;
  Writer* own_tf_static_ = nullptr;
};

}  // namespace ros2

// Names, frames and rates of what is served: by rule, or by a mapping file (docs/ros2.md). Values; any thread.
#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"

namespace ros2 {

struct RobotNames {
  std::string space;         // namespace: "/leader", or "/" for none
  std::string frame_prefix;  // "leader/", or empty
  // "scan" -> "/leader/scan"; a name that begins with / stays.
  std::string topic(const std::string& name) const { return name.front() == '/' ? name : (space == "/" ? "" : space) + "/" + name; }
  std::string frame(const std::string& name) const { return frame_prefix + name; }
};

// One topic of an iface, as the mapping file changes it.
struct TopicEntry {
  std::string iface{};  // "leader::laser"
  std::string type{};   // "sensor_msgs/msg/LaserScan"; empty: every topic of the iface
  std::optional<std::string> topic{}, frame{};
  std::optional<double> rate{};        // [Hz of simulated time] at most
  std::optional<bool> is_transient{};  // durability
  std::optional<std::size_t> depth{};
  bool is_served = true;
};

struct Naming {
  std::map<std::string, RobotNames> robots;   // by model
  std::map<std::string, std::string> spaces;  // by model: namespaces of robots that were spawned with one
  std::vector<TopicEntry> topics;
  std::optional<double> clock_rate;
  std::optional<std::uint32_t> domain;
  std::string root_robot;         // has no namespace and no prefix of frames
  bool has_tf_per_robot = false;  // "/leader/tf" with frames without prefix
  bool is_one_node = false;

  RobotNames names_of(const std::string& model) const;
  // The entry that applies; nothing when none does.
  const TopicEntry* entry(const std::string& iface, const std::string& type) const;
};

// Errors name the file, the line and what was expected.
base::Result<Naming> read_naming(const std::string& path);

}  // namespace ros2

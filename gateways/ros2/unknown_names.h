// Checks the names of the mapping file and of options against the world. Reports names that the world does not have (most are misspelled,
// others belong to models that are added later), and names that two parts share. Pure; any thread.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "naming.h"
#include "waits.h"

namespace ros2 {

// Names of the current world.
struct KnownNames {
  std::vector<std::string> robots, ifaces, command_topics;
  std::map<std::string, std::vector<std::string>> types;  // by iface: "sensor_msgs/msg/LaserScan", ...
};

// A line for each name, with the one that was most likely meant.
std::vector<std::string> lines_of_unknown_names(const Naming& naming, const std::vector<WaitFor>& waits, const KnownNames& known);

// Names that the gateway uses.
struct UsedNames {
  std::map<std::string, std::set<std::string>> writers;  // types that are published, by topic
  std::vector<std::string> commands;                     // their topics
  std::map<std::string, std::string> frame_prefixes;     // by robot, of frames on one /tf
};

// A line for each topic of two types, and for each robot that has the frames of another one.
std::vector<std::string> lines_of_shared_names(const UsedNames& used);

}  // namespace ros2

// Names in the mapping file and in options that the world does not have: most are misspelled, others belong to models that come later.
// Pure; any thread.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "naming.h"
#include "waits.h"

namespace ros2 {

// What the world has now.
struct KnownNames {
  std::vector<std::string> robots, ifaces, command_topics;
  std::map<std::string, std::vector<std::string>> types;  // by iface: "sensor_msgs/msg/LaserScan", ...
};

// A line for each name, with the one that was most likely meant.
std::vector<std::string> lines_of_unknown_names(const Naming& naming, const std::vector<WaitFor>& waits, const KnownNames& known);

}  // namespace ros2

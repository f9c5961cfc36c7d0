// Configuration files of Player (.cfg): which device of which model each port has. Sections driver ( key value ... ), comments after #,
// texts in quotes, lists in [ ], include "FILE", and define NAME driver ( ... ), whose keys a section NAME ( ... ) overrides. Values; any
// thread.
//
// A driver of a simulator (name "stage", "gazebo", "gz_..." or "rtm-sim", or with a model or gz_id) provides devices of that model: the
// first device of an interface is the first that the model has, and so on. A gz_id may also be the name of an iface, with parts behind it
// that no iface has. Addresses are [KEY:HOST:][PORT:]INTERFACE:INDEX; without a port 6665.
#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "mapping.h"

namespace gateway {

// A line begins with "driver" and a bracket, which may be on the next one.
bool is_of_player(const std::string& path);

// What is not served (other drivers, other interfaces) is a line of `notes`. Errors name the file, the line and what was expected.
base::Result<std::vector<ConfiguredPort>> read_player_config(const std::string& path, std::vector<std::string>& notes);

}  // namespace gateway

// A piece of a YAML file as one line, as it can stand in a list of another file. Any thread.
#pragma once

#include <string>

namespace YAML {
class Node;
}

namespace tools {

// In flow style ("{at: 1, command: true}"), however it was written; a text of several lines is quoted.
std::string flow_text(const YAML::Node& node);

}  // namespace tools

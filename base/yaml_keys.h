// Reads YAML, and checks what yaml-cpp does not: duplicate keys, further documents, files with a read error. Any thread.
#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace yaml {

// Throws a YAML::Exception at a key that a map has twice; of two values the second would be lost without a word.
void expect_unique_keys(const YAML::Node& root);

// The only document of a file; its keys are unique. Throws YAML::Exception, or YAML::BadFile if the file cannot be read.
YAML::Node load_file(const std::string& path);

}  // namespace yaml

// Checks of YAML that yaml-cpp does not make, such as duplicate keys. Any thread.
#pragma once

#include <yaml-cpp/yaml.h>

namespace yaml {

// Throws a YAML::Exception at a key that a map has twice; of two values the second would be lost without a word.
void expect_unique_keys(const YAML::Node& root);

}  // namespace yaml

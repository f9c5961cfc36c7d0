#include "run/flow_text.h"

#include <yaml-cpp/yaml.h>

namespace tools {
namespace {

constexpr int deepest = 32;  // an alias may stand in what it names

// The style of a node goes before that of the emitter, so each node must have it.
void set_flow(YAML::Node node, int depth) {
  if ((!node.IsMap() && !node.IsSequence()) || depth > deepest) return;
  node.SetStyle(YAML::EmitterStyle::Flow);
  for (const auto& entry : node) {
    if (node.IsSequence()) set_flow(entry, depth + 1);
    if (node.IsMap()) set_flow(entry.second, depth + 1);
  }
}

}  // namespace

std::string flow_text(const YAML::Node& node) {
  const auto copy = YAML::Clone(node);
  set_flow(copy, 0);
  YAML::Emitter flow;
  flow << YAML::Flow << copy;
  return flow.c_str();
}

}  // namespace tools

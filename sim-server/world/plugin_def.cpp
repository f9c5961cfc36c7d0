#include "world/plugin_def.h"

#include "base/text.h"

namespace sim {

const ParameterNode* ParameterNode::child(std::string_view child_name) const {
  for (const ParameterNode& node : children) {
    if (node.name == child_name) return &node;
  }
  return nullptr;
}

std::optional<std::string> ParameterNode::text_of(std::initializer_list<std::string_view> spellings) const {
  for (std::string_view spelling : spellings) {
    if (const ParameterNode* node = child(spelling)) return node->text;
  }
  return std::nullopt;
}

std::optional<double> ParameterNode::number_of(std::initializer_list<std::string_view> spellings) const {
  const std::optional<std::string> found = text_of(spellings);
  return found ? base::parse_number(*found) : std::nullopt;
}

std::optional<bool> ParameterNode::bool_of(std::initializer_list<std::string_view> spellings) const {
  const std::optional<std::string> found = text_of(spellings);
  return found ? base::parse_bool(*found) : std::nullopt;
}

std::string ParameterNode::attribute(std::string_view attribute_name) const {
  for (const auto& [key, value] : attributes) {
    if (key == attribute_name) return value;
  }
  return {};
}

}  // namespace sim

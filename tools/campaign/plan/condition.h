// A condition on a running system that is true or false between two steps. Values; any thread.
#pragma once

#include <optional>
#include <string>

namespace YAML {
class Node;
}

namespace campaign {

struct Condition {
  enum class Kind { value, region, touches, state };
  Kind kind = Kind::value;
  std::string text;  // in one line, for reports
  std::string port, member;
  std::optional<double> min, max;
  std::string model;
  double region[4] = {};
  std::string touched;  // a model, or "any"
  std::string component, state;
  double after_s = 0;
  std::optional<double> within_s;
};

// Of a node that fits the shape. Throws PlanError.
Condition to_condition(const YAML::Node& node);

}  // namespace campaign

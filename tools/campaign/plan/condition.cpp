#include "campaign/plan/condition.h"

#include <yaml-cpp/yaml.h>

#include <utility>

#include "base/text.h"
#include "campaign/plan/grammar.h"
#include "run/flow_text.h"

namespace campaign {
namespace {

std::optional<double> number(const YAML::Node& node, const char* key) {
  return node[key] ? base::parse_number(node[key].Scalar()) : std::nullopt;
}

}  // namespace

Condition to_condition(const YAML::Node& node) {
  Condition condition;
  condition.text = editor::flow_text(node);
  const int subjects = (node["port"] ? 1 : 0) + (node["model"] ? 1 : 0) + (node["component"] ? 1 : 0);
  if (subjects != 1) fail_at(node, "a condition must have one of port, model, component");
  condition.port = word(node, "port");
  condition.member = word(node, "member");
  condition.min = number(node, "min");
  condition.max = number(node, "max");
  condition.model = word(node, "model");
  condition.touched = word(node, "touches");
  condition.component = word(node, "component");
  condition.state = word(node, "is");
  condition.after_s = number(node, "after").value_or(0);
  condition.within_s = number(node, "within");
  if (node["port"]) {
    if (!node["member"] || (!condition.min && !condition.max)) fail_at(node, "a condition on a port needs member, and min or max");
    if (condition.min && condition.max && *condition.min > *condition.max) fail_at(node["max"], "max must not be less than min");
  } else if (node["component"]) {
    condition.kind = Condition::Kind::state;
    if (!node["is"]) fail_at(node, "a condition on a component needs is");
  } else {
    if (!node["region"] == !node["touches"]) fail_at(node, "a condition on a model needs region or touches");
    condition.kind = node["region"] ? Condition::Kind::region : Condition::Kind::touches;
    for (std::size_t i = 0; node["region"] && i < 4; ++i) condition.region[i] = *base::parse_number(node["region"][i].Scalar());
    if (condition.region[0] > condition.region[2]) std::swap(condition.region[0], condition.region[2]);
    if (condition.region[1] > condition.region[3]) std::swap(condition.region[1], condition.region[3]);
  }
  return condition;
}

}  // namespace campaign

#include "run/condition_words.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <utility>

#include "base/text.h"

namespace tools {
namespace {

using base::Error;
using base::Result;
using recorder::Expression;
using Sign = Expression::Sign;
using Value = Expression::Value;

Value constant(double number) { return {.number = number}; }

Expression within_bounds(const YAML::Node& node) {
  const auto min = number(node, "min"), max = number(node, "max");
  if (!node["member"]) fail_at(node, "a condition on a port needs member, and min or max");
  if (const auto path = member_path(word(node, "member")); !path) fail_at(node["member"], path.error().message);
  if (min && max && *min > *max) fail_at(node["max"], "max must not be less than min");
  const Value value{.kind = Value::Kind::port, .name = word(node, "port"), .member = word(node, "member")};
  std::vector<Expression> bounds;
  if (min) bounds.push_back(Expression::compare(constant(*min), Sign::less_equal, value));
  if (max) bounds.push_back(Expression::compare(value, Sign::less_equal, constant(*max)));
  return Expression::all_of(bounds);
}

Expression in_region(const YAML::Node& node) {
  const auto region = to_region(node["region"]);
  const Value x{.kind = Value::Kind::pose, .name = word(node, "model"), .member = "x"};
  const Value y{.kind = Value::Kind::pose, .name = word(node, "model"), .member = "y"};
  return Expression::all_of(
      {Expression::compare(constant(region.x1), Sign::less_equal, x), Expression::compare(constant(region.y1), Sign::less_equal, y),
       Expression::compare(x, Sign::less_equal, constant(region.x2)), Expression::compare(y, Sign::less_equal, constant(region.y2))});
}

Expression touches(const YAML::Node& node) {
  return Expression::compare({.kind = Value::Kind::touches, .name = word(node, "model"), .member = word(node, "touches")}, Sign::not_equal,
                             constant(0));
}

Expression in_state(const YAML::Node& node) {
  const auto wanted = word(node, "is");
  const auto state = recorder::state_number(wanted);
  if (!state) fail_at(node["is"], "is must be Created, Inactive, Active or Error, got " + base::in_quotes(wanted));
  auto component = word(node, "component");
  if (component.ends_with(".rtc")) component.resize(component.size() - 4);
  return Expression::compare({.kind = Value::Kind::state, .name = component}, Sign::equal, constant(*state));
}

struct ConditionRow {
  const char* subject;
  std::array<const char*, 2> words;  // one of them makes it this condition
  const char* needs;                 // of all conditions on this subject
  Expression (*expression)(const YAML::Node&);
};
constexpr std::array condition_rows = {
    ConditionRow{"port", {"min", "max"}, "member, and min or max", within_bounds},
    ConditionRow{"model", {"region", "region"}, "region or touches", in_region},
    ConditionRow{"model", {"touches", "touches"}, "region or touches", touches},
    ConditionRow{"component", {"is", "is"}, "is", in_state},
};

}  // namespace

Expression to_expression(const YAML::Node& node) {
  std::set<std::string> subjects;
  const ConditionRow* subject = nullptr;
  std::vector<const ConditionRow*> meant;
  for (const auto& row : condition_rows) {
    if (!node[row.subject]) continue;
    subjects.insert((subject = &row)->subject);
    if (node[row.words[0]] || node[row.words[1]]) meant.push_back(&row);
  }
  if (subjects.size() != 1) fail_at(node, "a condition must have one of port, model, component");
  if (meant.size() != 1) fail_at(node, std::string("a condition on a ") + subject->subject + " needs " + subject->needs);
  return meant.front()->expression(node);
}

Result<std::vector<std::string>> member_path(const std::string& member) {
  std::vector<std::string> steps;
  std::string step;
  const auto flush = [&] {
    if (step.empty()) return false;
    steps.push_back(std::exchange(step, ""));
    return true;
  };
  const Error wrong{"member " + base::in_quotes(member) + ": expected a path like data.vx or ranges[0]"};
  for (std::size_t i = 0; i < member.size(); ++i) {
    const char c = member[i];
    if (c == '.' || c == '[') {
      const bool after_index = i > 0 && member[i - 1] == ']';
      if (!flush() && !after_index) return wrong;
    }
    if (c == '[') {
      const auto end = member.find(']', i);
      const auto index = end == std::string::npos ? std::nullopt : base::parse_integer(member.substr(i + 1, end - i - 1));
      if (!index || *index < 0) return wrong;
      steps.push_back(std::to_string(*index));
      i = end;
    } else if (c != '.') {
      if (c != '_' && !std::isalnum(static_cast<unsigned char>(c))) return wrong;
      if (i > 0 && member[i - 1] == ']') return wrong;
      step += c;
    }
  }
  if (!flush() && !member.ends_with(']')) return wrong;
  return steps;
}

double member_of(const shm::Pose& pose, const std::string& member) {
  if (member == "x") return pose.x;
  if (member == "y") return pose.y;
  return member == "z" ? pose.z : shm::yaw_of(pose);
}

bool is_touching(const std::vector<ModelContact>& contacts, const std::string& other) {
  return std::ranges::any_of(contacts, [&](const ModelContact& contact) {
    const auto model = contact.other.substr(0, contact.other.find("::"));
    return other == "any" ? model != usually_touched : model == other;
  });
}

}  // namespace tools

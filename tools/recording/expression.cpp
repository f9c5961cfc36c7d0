#include "recording/expression.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

#include "base/text.h"

namespace recorder {

struct Expression::Node {
  enum class Kind { all, any, negated, compared } kind = Kind::all;
  std::vector<std::shared_ptr<const Node>> parts;
  // Of a comparison:
  Value left{}, right{};
  Sign sign = Sign::less;
};

namespace {

using Node = Expression::Node;
using Sign = Expression::Sign;
using Value = Expression::Value;
using NodePointer = std::shared_ptr<const Node>;

constexpr int deepest_nesting = 64;
constexpr std::array state_names = {"Created", "Inactive", "Active", "Error"};  // by LifeCycleState
constexpr const char* state_unit = "states";

struct SignRow {
  std::string_view text;
  Sign sign;
  bool is_turned = false;
};
constexpr std::array sign_rows = {SignRow{"<=", Sign::less_equal}, SignRow{"<", Sign::less},   SignRow{">=", Sign::less_equal, true},
                                  SignRow{">", Sign::less, true},  SignRow{"==", Sign::equal}, SignRow{"!=", Sign::not_equal}};

struct UnitRow {
  const char* name;
  const char* unit;  // of values
  double factor;
};
constexpr std::array unit_rows = {UnitRow{"m", "m", 1},
                                  UnitRow{"cm", "m", 0.01},
                                  UnitRow{"mm", "m", 0.001},
                                  UnitRow{"rad", "rad", 1},
                                  UnitRow{"deg", "rad", std::numbers::pi / 180},
                                  UnitRow{"s", "s", 1},
                                  UnitRow{"ms", "s", 0.001},
                                  UnitRow{"min", "s", 60}};

NodePointer joined_node(Node::Kind kind, std::vector<NodePointer> parts) { return std::make_shared<Node>(Node{kind, std::move(parts)}); }

NodePointer comparison_node(Value left, Sign sign, Value right) {
  return std::make_shared<Node>(Node{Node::Kind::compared, {}, std::move(left), std::move(right), sign});
}

class Parser {
 public:
  Parser(const std::string& text, std::set<Value>& values) : text_(text), values_(values) {}

  base::Result<NodePointer> whole() {
    auto node = joined(0);
    if (!node) return node;
    skip();
    if (at_ < text_.size()) return wrong("&& or || or the end");
    return node;
  }

 private:
  // What was expected at the next word.
  base::Error wrong(const std::string& expected) {
    skip();
    const auto at = at_;
    auto found = word();
    if (found.empty() && at < text_.size()) found = text_[at];
    return {"condition " + base::in_quotes(text_) + ":" + std::to_string(at + 1) + ": expected " + expected + ", got " +
            (found.empty() ? "the end" : base::in_quotes(found))};
  }
  base::Error too_deep() const {
    return {"condition " + base::in_quotes(text_) + ":" + std::to_string(at_ + 1) + ": expected at most " +
            std::to_string(deepest_nesting) + " conditions in each other"};
  }
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  bool take(std::string_view token) {
    skip();
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }

  // Conditions joined by ||, each of conditions joined by &&.
  base::Result<NodePointer> joined(int depth, bool by_and = false) {
    if (depth > deepest_nesting) return too_deep();
    std::vector<NodePointer> parts;
    do {
      auto part = by_and ? single(depth + 1) : joined(depth + 1, true);
      if (!part) return part;
      parts.push_back(std::move(*part));
    } while (take(by_and ? "&&" : "||"));
    return joined_node(by_and ? Node::Kind::all : Node::Kind::any, std::move(parts));
  }

  base::Result<NodePointer> single(int depth) {
    if (depth > deepest_nesting) return too_deep();
    skip();
    if (at_ + 1 < text_.size() && text_[at_] == '!' && text_[at_ + 1] != '=') {
      ++at_;
      auto part = single(depth + 1);
      if (!part) return part;
      return joined_node(Node::Kind::negated, {std::move(*part)});
    }
    if (!take("(")) return comparison();
    auto inside = joined(depth + 1);
    if (!inside) return inside;
    if (!take(")")) return wrong(")");
    return inside;
  }

  base::Result<NodePointer> comparison() {
    auto left = value();
    if (!left) return left.error();
    if (left->kind == Value::Kind::touches) return comparison_node(std::move(*left), Sign::not_equal, {});
    for (const auto& [text, sign, is_turned] : sign_rows) {
      if (!take(text)) continue;
      skip();
      const auto begin = at_;
      auto right = value();
      if (!right) return right.error();
      if (!left->unit.empty() && !right->unit.empty() && left->unit != right->unit) {
        at_ = begin;
        return wrong("a value in " + left->unit + ", not in " + right->unit);
      }
      if (is_turned) std::swap(*left, *right);
      return comparison_node(std::move(*left), sign, std::move(*right));
    }
    return wrong("<, <=, >, >=, == or !=");
  }

  std::string word() {
    skip();
    const auto begin = at_;
    const auto belongs = [](char c) {
      return std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("_:.[]/-+").find(c) != std::string_view::npos;
    };
    while (at_ < text_.size() && belongs(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  // One that must be looked up.
  Value known(Value value) {
    values_.insert(value);
    return value;
  }

  // "5", "5 cm" and "5cm"; nothing: the word is no number.
  std::optional<Value> number(const std::string& text) {
    const auto size = text.find_last_not_of("acdegimnrs") + 1;  // letters of units
    const auto value = base::parse_number(text.substr(0, size));
    if (!value) return std::nullopt;
    const auto behind = at_;
    const auto unit = size < text.size() ? text.substr(size) : word();
    const auto row = std::ranges::find_if(unit_rows, [&](const UnitRow& one) { return one.name == unit; });
    if (row != unit_rows.end()) return Value{.number = *value * row->factor, .unit = row->unit};
    at_ = behind;
    return size < text.size() ? std::nullopt : std::optional(Value{.number = *value});
  }

  // state(COMPONENT), pose(MODEL).x, touches(MODEL, OTHER), after their first word.
  base::Result<Value> function(const std::string& function) {
    if (!take("(")) return wrong("( and a name");
    const std::string of = word();
    if (of.empty()) return wrong("a name and )");
    std::string other;
    if (function == "touches") {
      if (!take(",") || (other = word()).empty()) return wrong("a comma and another model");
    }
    if (!take(")")) return wrong("a name and )");
    if (function == "touches") return known({Value::Kind::touches, 0, of, other, ""});
    if (function == "state") return known({Value::Kind::state, 0, of, "", state_unit});
    skip();
    const auto begin = at_;
    const std::string member = word();
    for (const char* one : {".x", ".y", ".z", ".yaw"}) {
      if (member == one) return known({Value::Kind::pose, 0, of, member.substr(1), member == ".yaw" ? "rad" : "m"});
    }
    at_ = begin;
    return wrong(".x, .y, .z or .yaw");
  }

  base::Result<Value> value() {
    skip();
    const auto begin = at_;
    const std::string name = word();
    if (name.empty()) return wrong("a value");
    if (auto one = number(name)) return std::move(*one);
    const auto state = std::ranges::find(state_names, name);
    if (state != state_names.end()) return Value{.number = static_cast<double>(state - state_names.begin()), .unit = state_unit};
    if (name == "time") return known({Value::Kind::time, 0, "", "", "s"});
    if (name == "state" || name == "pose" || name == "touches") return function(name);
    const auto colon = name.find(':');
    const auto dot = name.find('.', colon == std::string::npos ? 0 : colon);
    if (colon == std::string::npos || dot == std::string::npos || dot + 1 == name.size()) {
      at_ = begin;
      return wrong("a number, time, pose(MODEL).x, state(COMPONENT), touches(MODEL, OTHER) or COMPONENT:PORT.member");
    }
    return known({Value::Kind::port, 0, name.substr(0, dot), name.substr(dot + 1), ""});
  }

  const std::string& text_;
  std::set<Value>& values_;
  std::size_t at_ = 0;
};

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr double least = std::numeric_limits<double>::denorm_min();  // what 2 < 2 lacks

double lack(Sign sign, double left, double right) {
  using enum Expression::Sign;
  if (std::isnan(left) || std::isnan(right)) return sign == not_equal ? 0 : infinite;
  switch (sign) {
    case less:
      return left < right ? 0 : std::max(left - right, least);
    case less_equal:
      return left <= right ? 0 : left - right;
    case equal:
      return left == right ? 0 : std::abs(left - right);
    default:
      return left != right ? 0 : infinite;
  }
}

// The shortfall. `is_sum`: of all parts; else the first part that decides ends the evaluation, and only 0 means something.
base::Result<double> evaluate(const Node& node, const Expression::Lookup& look_up, bool is_sum) {
  using enum Node::Kind;
  if (node.kind != compared) {
    double sum = node.kind == any ? infinite : 0;
    for (const auto& part : node.parts) {
      const auto one = evaluate(*part, look_up, is_sum);
      if (!one) return one;
      sum = node.kind == any ? std::min(sum, *one) : std::hypot(sum, *one);
      if (node.kind == any ? sum == 0 : sum > 0 && !is_sum) break;
    }
    return node.kind != negated ? sum : sum > 0 ? 0.0 : infinite;
  }
  std::optional<double> sides[2] = {node.left.number, node.right.number};
  for (const auto& [side, value] : {std::pair(&sides[0], &node.left), std::pair(&sides[1], &node.right)}) {
    if (value->kind == Value::Kind::number) continue;
    auto found = look_up(*value);
    if (!found) return found.error();
    *side = *found;
  }
  return sides[0] && sides[1] ? lack(node.sign, *sides[0], *sides[1]) : infinite;
}

}  // namespace

base::Result<Expression> Expression::parse(const std::string& text) {
  Expression expression;
  auto root = Parser(text, expression.values_).whole();
  if (!root) return root.error();
  expression.root_ = std::move(*root);
  return expression;
}

Expression Expression::compare(const Value& left, Sign sign, const Value& right) {
  Expression expression;
  expression.root_ = comparison_node(left, sign, right);
  for (const auto* value : {&left, &right}) {
    if (value->kind != Value::Kind::number) expression.values_.insert(*value);
  }
  return expression;
}

Expression Expression::all_of(const std::vector<Expression>& parts) {
  Expression expression;
  std::vector<NodePointer> nodes;
  for (const auto& part : parts) {
    nodes.push_back(part.root_);
    expression.values_.insert(part.values_.begin(), part.values_.end());
  }
  expression.root_ = joined_node(Node::Kind::all, std::move(nodes));
  return expression;
}

base::Result<bool> Expression::holds(const Lookup& look_up) const {
  const auto lacking = evaluate(*root_, look_up, false);
  return lacking ? base::Result<bool>(*lacking == 0) : lacking.error();
}

base::Result<double> Expression::shortfall(const Lookup& look_up) const { return evaluate(*root_, look_up, true); }

std::optional<double> state_number(const std::string& name) {
  const auto found = std::ranges::find_if(state_names, [&](const char* one) { return base::equal_ignoring_case(one, name); });
  return found == state_names.end() ? std::nullopt : std::optional(static_cast<double>(found - state_names.begin()));
}

}  // namespace recorder

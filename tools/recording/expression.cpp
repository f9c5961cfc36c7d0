#include "recording/expression.h"

#include <algorithm>
#include <cctype>
#include <utility>

#include "base/text.h"

namespace recorder {

struct Expression::Node {
  enum class Kind { all, any, negated, less, less_equal, equal, not_equal } kind = Kind::all;
  std::vector<std::shared_ptr<const Node>> parts;
  Value left, right;  // of a comparison
};

namespace {

using Node = Expression::Node;
using Value = Expression::Value;
using NodePointer = std::shared_ptr<const Node>;

constexpr int deepest_nesting = 64;

class Parser {
 public:
  Parser(const std::string& text, std::set<Value>& values) : text_(text), values_(values) {}

  base::Result<NodePointer> whole() {
    auto node = joined(0);
    if (!node) return node;
    skip();
    if (at_ < text_.size()) return wrong("expected && or || or the end");
    return node;
  }

 private:
  base::Error wrong(const std::string& what) const {
    return base::Error{"condition " + base::in_quotes(text_) + ": at octet " + std::to_string(at_ + 1) + ": " + what};
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
    if (depth > deepest_nesting) return wrong("it is nested too deep");
    auto node = std::make_shared<Node>();
    node->kind = by_and ? Node::Kind::all : Node::Kind::any;
    do {
      auto part = by_and ? single(depth + 1) : joined(depth + 1, true);
      if (!part) return part;
      node->parts.push_back(std::move(*part));
    } while (take(by_and ? "&&" : "||"));
    return NodePointer(node);
  }

  base::Result<NodePointer> single(int depth) {
    if (depth > deepest_nesting) return wrong("it is nested too deep");
    skip();
    if (at_ + 1 < text_.size() && text_[at_] == '!' && text_[at_ + 1] != '=') {
      ++at_;
      auto part = single(depth + 1);
      if (!part) return part;
      return NodePointer(std::make_shared<Node>(Node{Node::Kind::negated, {std::move(*part)}, {}, {}}));
    }
    if (!take("(")) return comparison();
    auto inside = joined(depth + 1);
    if (!inside) return inside;
    if (!take(")")) return wrong("expected )");
    return inside;
  }

  base::Result<NodePointer> comparison() {
    auto left = value();
    if (!left) return left.error();
    using enum Node::Kind;
    struct Sign {
      std::string_view text;
      Node::Kind kind;
      bool is_turned;
    };
    for (const auto& [text, kind, is_turned] : {Sign{"<=", less_equal, false}, Sign{"<", less, false}, Sign{">=", less_equal, true},
                                                Sign{">", less, true}, Sign{"==", equal, false}, Sign{"!=", not_equal, false}}) {
      if (!take(text)) continue;
      auto right = value();
      if (!right) return right.error();
      if (is_turned) std::swap(*left, *right);
      return NodePointer(std::make_shared<Node>(Node{kind, {}, std::move(*left), std::move(*right)}));
    }
    return wrong("expected <, <=, >, >=, == or !=");
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

  base::Result<Value> known(Value value) {
    values_.insert(value);
    return value;
  }

  base::Result<Value> value() {
    const auto begin = at_;
    const std::string name = word();
    if (name.empty()) return wrong("expected a value");
    if (const auto number = base::parse_number(name)) return Value{.number = *number};
    for (const auto& [state, number] : {std::pair("Inactive", 1.0), std::pair("Active", 2.0), std::pair("Error", 3.0)}) {
      if (name == state) return Value{.number = number};
    }
    if (name == "time") return known({Value::Kind::time, 0, "", ""});
    if (name == "state" || name == "pose") {
      if (!take("(")) return wrong("expected ( and a name");
      const std::string of = word();
      if (of.empty() || !take(")")) return wrong("expected a name and )");
      if (name == "state") return known({Value::Kind::state, 0, of, ""});
      const std::string member = word();
      for (const char* one : {".x", ".y", ".z", ".yaw"}) {
        if (member == one) return known({Value::Kind::pose, 0, of, member.substr(1)});
      }
      return wrong("expected .x, .y, .z or .yaw");
    }
    const auto colon = name.find(':');
    const auto dot = name.find('.', colon == std::string::npos ? 0 : colon);
    if (colon == std::string::npos || dot == std::string::npos || dot + 1 == name.size()) {
      at_ = begin;
      return wrong("expected a number, time, pose(MODEL).x, state(COMPONENT) or COMPONENT:PORT.member");
    }
    return known({Value::Kind::port, 0, name.substr(0, dot), name.substr(dot + 1)});
  }

  const std::string& text_;
  std::set<Value>& values_;
  std::size_t at_ = 0;
};

bool evaluate(const Node& node, const Expression::Lookup& look_up) {
  using enum Node::Kind;
  const auto part_holds = [&](const NodePointer& part) { return evaluate(*part, look_up); };
  switch (node.kind) {
    case all:
      return std::ranges::all_of(node.parts, part_holds);
    case any:
      return std::ranges::any_of(node.parts, part_holds);
    case negated:
      return !part_holds(node.parts.front());
    default:
      break;
  }
  const auto number = [&](const Value& value) { return value.kind == Value::Kind::number ? std::optional(value.number) : look_up(value); };
  const auto left = number(node.left);
  const auto right = number(node.right);
  if (!left || !right) return false;
  switch (node.kind) {
    case less:
      return *left < *right;
    case less_equal:
      return *left <= *right;
    case equal:
      return *left == *right;
    default:
      return *left != *right;
  }
}

}  // namespace

base::Result<Expression> Expression::parse(const std::string& text) {
  Expression expression;
  auto root = Parser(text, expression.values_).whole();
  if (!root) return root.error();
  expression.root_ = std::move(*root);
  return expression;
}

bool Expression::holds(const Lookup& look_up) const { return evaluate(*root_, look_up); }

}  // namespace recorder

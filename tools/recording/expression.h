// Conditions over what a run shows: "LaserObstacleAvoid0:velocity.data.vx < 0.1 && pose(pioneer2dx).x > 2". Values; any thread.
//
//   condition   comparison, or conditions joined by && (binds more) and ||, in parentheses where need be, with ! before them
//   comparison  VALUE < VALUE, and <=, >, >=, ==, !=
//   VALUE       a number, time [s], pose(MODEL).x y z yaw [m, rad], state(COMPONENT), Inactive, Active, Error,
//               COMPONENT:PORT.member.of[3].it: of the latest sample
//
// A comparison with a value that is not there (yet) is false.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "base/result.h"

namespace recorder {

class Expression {
 public:
  struct Value {
    enum class Kind { number, time, pose, state, port } kind = Kind::number;
    double number = 0;
    std::string name{};    // of the model, the component, or COMPONENT:PORT
    std::string member{};  // of the pose or the sample
    bool operator<(const Value& other) const { return std::tie(kind, name, member) < std::tie(other.kind, other.name, other.member); }
  };
  using Lookup = std::function<std::optional<double>(const Value&)>;

  static base::Result<Expression> parse(const std::string& text);
  bool holds(const Lookup& look_up) const;
  // All that it needs, each once; no numbers.
  const std::set<Value>& values() const { return values_; }

  struct Node;

 private:
  std::shared_ptr<const Node> root_;
  std::set<Value> values_;
};

}  // namespace recorder

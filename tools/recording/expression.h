// Conditions over what a run shows: "LaserObstacleAvoid0:velocity.data.vx < 0.1 && pose(pioneer2dx).x > 2 m". Values; any thread.
//
//   condition   comparison, or conditions joined by && (binds more) and ||, in parentheses where need be, with ! before them
//   comparison  VALUE < VALUE, and <=, >, >=, ==, !=; or touches(MODEL, OTHER)
//   VALUE       a number, with a unit if wanted: m cm mm, rad deg, s ms min
//               time [s], pose(MODEL).x y z [m], pose(MODEL).yaw [rad], state(COMPONENT), Created, Inactive, Active, Error,
//               COMPONENT:PORT.member.of[3].it: of the latest sample, in the unit of the data type
//
// A comparison with a value that is missing is false. Values of two known units cannot be compared. Errors of a text:
// condition "TEXT":COLUMN: what was expected, what was found. Maps of YAML files are conditions, too: run/condition_words.h.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "base/result.h"

namespace recorder {

class Expression {
 public:
  struct Value {
    enum class Kind { number, time, pose, state, touches, port } kind = Kind::number;
    double number = 0;
    std::string name{};    // of the model, the component, or COMPONENT:PORT
    std::string member{};  // of the pose or the sample; of touches: the other model
    std::string unit{};    // "m", "rad", "s", "states"; empty: any
    bool operator<(const Value& other) const { return std::tie(kind, name, member) < std::tie(other.kind, other.name, other.member); }
  };
  // Nothing: the value is missing. An Error ends the evaluation.
  using Lookup = std::function<base::Result<std::optional<double>>(const Value&)>;

  static base::Result<Expression> parse(const std::string& text);
  // The same without a text, for names of any form.
  enum class Sign { less, less_equal, equal, not_equal };
  static Expression compare(const Value& left, Sign sign, const Value& right);
  static Expression all_of(const std::vector<Expression>& parts);

  base::Result<bool> holds(const Lookup& look_up) const;
  // How much the values must change until it holds; 0 if it holds. Of joined conditions: the Euclidean norm, or the least. Of != and of
  // missing values: infinite.
  base::Result<double> shortfall(const Lookup& look_up) const;
  // All that it needs, each once; no numbers.
  const std::set<Value>& values() const { return values_; }

  struct Node;

 private:
  std::shared_ptr<const Node> root_;
  std::set<Value> values_;
};

// Created, Inactive, Active or Error in any case, as a number; nothing: it is none of them.
std::optional<double> state_number(const std::string& name);

}  // namespace recorder

// The actions of a plan in a run: events, which change the system as a user could, and faults, which break a part of it for a while.
// Values; any thread.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recording/expression.h"

namespace YAML {
class Node;
}

namespace campaign {

// On a running system; true or false between two steps.
struct Condition {
  std::string text;  // in one line, for reports
  recorder::Expression expression;
  double after_s = 0;
  std::optional<double> within_s;
};

struct Event {
  enum class Kind { spawn, remove, push, wrench, joint_force, pose, set, activate, deactivate, reset, connect, disconnect, command };
  Kind kind = Kind::command;
  std::string text;  // in one line, for reports
  std::optional<double> at_s;
  std::optional<Condition> when;
  std::string target;                // model, component, connection, file to spawn, command line; MODEL::JOINT of a joint_force
  std::string name;                  // of what is spawned; of the parameter
  std::string value;                 // of the parameter
  std::vector<std::string> numbers;  // pose, force
  double duration_s = 0;             // of a push, wrench or joint_force
  bool stays = false;                // likewise: until the next one that stays
};

struct Fault {
  enum class Object { sensor, actuator, connector, component, naming };
  enum class Kind {
    off,
    stuck,
    bias,
    noise,
    missing,
    latency,
    dropout,
    weak,
    drop,
    delay,
    duplicate,
    reorder,
    error,
    exception,
    slow,
    hang,
    kill,
    gone,
  };
  Object object = Object::component;
  Kind kind = Kind::error;
  std::string target;
  double at_s = 0;
  std::optional<double> for_s;
  double amount = 0;

  std::string text() const;  // as it stands in a plan, in one line
};

std::string_view to_text(Fault::Object object);
std::string_view to_text(Fault::Kind kind);
std::optional<Fault::Kind> fault_kind(std::string_view word);
// Which faults an object can have.
std::vector<Fault::Kind> faults_of(Fault::Object object);
// What the amount is without one in the plan; nothing: it has none.
std::optional<double> usual_amount(Fault::Kind kind);

// Sets the file of a spawn, in its text too.
void set_spawned(Event& event, const std::string& file);

// Of nodes that fit the shapes. Throw YamlFailure.
Condition to_condition(const YAML::Node& node);  // see run/condition_words.h
Event to_event(const YAML::Node& node);
Fault to_fault(const YAML::Node& node);

}  // namespace campaign

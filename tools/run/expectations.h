// Expectations of a run from a YAML file, and their verdicts. Pure but for reading files; any thread.
//
//   - path_length: {model: pioneer2dx, min: 10, max: 40}                      metres
//   - reach: {model: pioneer2dx, region: [3, 3, 5, 5], within: 60}            corners x1 y1 x2 y2; seconds of simulated time
//   - stay: {model: pioneer2dx, region: [-6, -6, 6, 6]}
//   - no_contact: {model: pioneer2dx, except: [ground_plane]}                 what it may touch: a name or a list; default: ground_plane
//   - value: {port: "LaserObstacleAvoid0:velocity", member: data.vx, min: -0.2, max: 0.2}
//   - state: {component: RTCLaser0, is: Active}
//   - joint: {model: arm, name: elbow, min: 1.4, max: 1.6, within: 5}         rad or m; reached before `within` [s]. Without it: never
//                                                                             outside. Seen ten times a simulated second
//   - holds: {gripper: arm::hand, model: red_box}                             at the end; MODEL, if it has one gripper, or the gripper's
//   name
//   - command: "./my-check.sh"                                                exit code 0 within 60 s of real time; it finds RTMSIM_RECORD,
//                                                                             RTMSIM_SERVER_ID and RTCTREE_NAMESERVERS
//
// A `member` is a path in the sample, data.vx or ranges[0]; true and false count as 1 and 0.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "run/condition_words.h"
#include "run/model_parts.h"
#include "run/pose_record.h"

namespace tools {

struct Expectation {
  enum class Kind { path_length, reach, stay, no_contact, value, state, joint, holds, command };
  Kind kind = Kind::command;
  std::string text;  // the whole expectation in one line, its name in reports
  std::string model;
  std::optional<double> min, max;
  double within = 0;               // [s]; 0: the whole run
  recorder::Expression condition;  // of reach, at one time; of stay and value, at all times; of state, at the end
  std::vector<std::string> except;
  std::string port, member;
  std::string component;
  std::string joint;    // of the model
  std::string gripper;  // that holds the model
  std::string command;
  // MODEL::JOINT
  std::string joint_name() const { return model + "::" + joint; }
};

// The error names the file, line and column, and what was expected there.
base::Result<std::vector<Expectation>> read_expectations(const std::string& file);
// Of a text that stands elsewhere: errors begin with what it is of.
base::Result<std::vector<Expectation>> parse_expectations(const std::string& text, const std::string& what);

struct SeenValue {
  std::size_t samples = 0;      // that had the member as a number
  std::size_t not_numbers = 0;  // of these: NaN
  double lowest = 0, highest = 0;
  double sum = 0, last = 0;  // of the numbers
  std::string problem;       // why other samples did not count
  bool is_over = false;      // the component that sent the last one was killed
  // By text of the expectation: the stamp [s] of the first sample that violated it.
  std::map<std::string, double> violated_at = {};
  void take(double number);
  // Of the numbers that were no NaN; nothing when there were none.
  std::optional<double> mean() const;
};

// How a command of the user's ended; `text` is what it said last, or why it has no exit code.
struct SeenCommand {
  std::optional<int> exit_code;
  std::string text;
  std::string output = {};  // its last lines
};

// All that a run has shown.
struct Seen {
  PoseRecord record;
  std::vector<std::string> models;            // all of the world
  std::map<std::string, SeenValue> values;    // by "port member"
  std::map<std::string, std::string> states;  // by component
  std::map<std::string, SeenCommand> commands;
  std::vector<ModelParts> parts;             // of the world
  std::map<std::string, std::string> grips;  // at the end, by gripper and model as in grip_name(); what is wrong, or empty: it is held
};

struct Verdict {
  std::string expectation;
  std::string problem;              // empty: fulfilled
  std::string details = {};         // what a command that failed had said: its last lines
  std::string failure = {};         // the problem as a sentence of its own, which begins with what failed; empty: EXPECTATION: PROBLEM
  std::optional<double> time = {};  // of the failure [simulated s]; nothing: not known, or the end of the run
  std::string subject = {};         // the model or component that failed; empty: not known
};
// The line to print of one that is not fulfilled.
std::string failure_text(const Verdict& verdict);
// Values of expressions on this model.
recorder::Expression::Lookup values_at(const RecordedPose& pose);

std::vector<Verdict> judge(const std::vector<Expectation>& expectations, const Seen& seen);

}  // namespace tools

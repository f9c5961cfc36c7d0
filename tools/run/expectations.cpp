#include "run/expectations.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <utility>

#include "base/plain_file.h"
#include "base/text.h"
#include "base/yaml_keys.h"
#include "run/flow_text.h"
#include "run/verdict_time.h"
#include "run/yaml_shape.h"

namespace tools {
namespace {

using base::Error;
using base::Result;
using Kind = Expectation::Kind;

constexpr std::array path_length_keys = {Key{"model", Form::text, {}, true}, Key{"min", Form::number}, Key{"max", Form::number}};
constexpr std::array region_keys = {Key{"model", Form::text, {}, true}, Key{"region", Form::region, {}, true},
                                    Key{"within", Form::positive}};
constexpr std::array no_contact_keys = {Key{"model", Form::text, {}, true}, Key{"except", Form::any}};
constexpr std::array value_keys = {Key{"port", Form::text, {}, true}, Key{"member", Form::text, {}, true}, Key{"min", Form::number},
                                   Key{"max", Form::number}};
constexpr std::array state_keys = {Key{"component", Form::text, {}, true}, Key{"is", Form::text, {}, true}};
constexpr std::array joint_keys = {Key{"model", Form::text, {}, true}, Key{"name", Form::text, {}, true}, Key{"min", Form::number},
                                   Key{"max", Form::number}, Key{"within", Form::positive}};
constexpr std::array holds_keys = {Key{"gripper", Form::text, {}, true}, Key{"model", Form::text, {}, true}};

// By Kind.
constexpr std::array expectation_shapes = {Shape{"path_length", path_length_keys},
                                           Shape{"reach", region_keys},
                                           Shape{"stay", region_keys},
                                           Shape{"no_contact", no_contact_keys},
                                           Shape{"value", value_keys},
                                           Shape{"state", state_keys},
                                           Shape{"joint", joint_keys},
                                           Shape{"holds", holds_keys},
                                           Shape{"command", {}}};

// What a model may touch: a model, or a list of them, which may be empty.
std::vector<std::string> to_except(const YAML::Node& node) {
  if (!node) return {usually_touched};
  const auto is_plain = [](const YAML::Node& one) { return one.IsScalar(); };
  if (!node.IsScalar() && !(node.IsSequence() && std::all_of(node.begin(), node.end(), is_plain)))
    fail_at(node, "except must be a model or a list of models");
  return words(node);
}

Expectation read_one(const YAML::Node& name, const YAML::Node& node) {
  const auto row = std::ranges::find(expectation_shapes, name.Scalar(), &Shape::name);
  if (row == expectation_shapes.end())
    fail_at(name, "unknown expectation " + base::in_quotes(name.Scalar()) +
                      ", expected path_length, reach, stay, no_contact, value, state, joint, holds or command");
  Expectation expectation;
  expectation.kind = static_cast<Kind>(row - expectation_shapes.begin());
  expectation.text = name.Scalar() + ": " + flow_text(node);
  if (expectation.kind == Kind::command) {
    if (!node.IsScalar() || node.Scalar().empty()) fail_at(node, "command needs a command line");
    expectation.command = node.Scalar();
    return expectation;
  }
  check_shape(expectation_shapes, node, row->name, name.Scalar());
  expectation.model = word(node, "model");
  expectation.min = number(node, "min");
  expectation.max = number(node, "max");
  expectation.within = number(node, "within").value_or(0);
  expectation.port = word(node, "port");
  expectation.member = word(node, "member");
  expectation.joint = word(node, "name");
  expectation.gripper = word(node, "gripper");
  const auto is_one_of = [&](std::initializer_list<Kind> kinds) { return std::ranges::find(kinds, expectation.kind) != kinds.end(); };
  const bool bounded = is_one_of({Kind::path_length, Kind::value, Kind::joint});
  if (bounded && !expectation.min && !expectation.max) fail_at(node, name.Scalar() + " needs min or max");
  if (bounded && expectation.min && expectation.max && *expectation.min > *expectation.max)
    fail_at(node["max"], "max must not be less than min");
  if (expectation.kind == Kind::no_contact) expectation.except = to_except(node["except"]);
  if (is_one_of({Kind::reach, Kind::stay, Kind::value, Kind::state})) expectation.condition = to_expression(node);
  if (expectation.kind == Kind::state) expectation.component = expectation.condition.values().begin()->name;
  return expectation;
}

// What was measured, to six digits; limits are shown as they were given.
std::string measured(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

std::string bounds(const Expectation& e) {
  if (e.min && e.max) return "from " + base::format_number(*e.min) + " to " + base::format_number(*e.max);
  return e.min ? "at least " + base::format_number(*e.min) : "at most " + base::format_number(*e.max);
}

std::string place(const RecordedPose& pose) {
  return "(" + measured(pose.x) + ", " + measured(pose.y) + ") at " + measured(pose.time) + " s";
}

std::string region_problem(const Expectation& e, const std::vector<RecordedPose>& poses) {
  double nearest = INFINITY;
  for (const auto& pose : poses) {
    if (e.within > 0 && pose.time > e.within) break;
    const double distance = e.condition.shortfall(values_at(pose)).value();
    if (e.kind == Kind::reach && distance == 0) return "";
    if (e.kind == Kind::stay && distance > 0) return "it was at " + place(pose);
    nearest = std::min(nearest, distance);
  }
  return e.kind == Kind::stay ? "" : "it came no nearer than " + measured(nearest) + " m";
}

template <class Names>
std::string names_in(const Names& all) {
  std::vector<std::string> names;
  for (const auto& entry : all) {
    if constexpr (requires { entry.first; }) {
      names.push_back(entry.first);
    } else {
      names.push_back(entry);
    }
  }
  return names.empty() ? "none" : base::join(names, ", ");
}

std::string contact_problem(const Expectation& e, const PoseRecord& record, const std::vector<std::string>& models) {
  for (const auto& name : e.except) {
    const bool is_default = name == usually_touched;
    if (!is_default && std::find(models.begin(), models.end(), name) == models.end())
      return "the world has no model " + base::in_quotes(name) + " that may be touched; models: " + names_in(models);
  }
  for (const auto& contact : record.contacts) {
    const auto& other = contact.model == e.model ? contact.other : contact.model;
    if (contact.model != e.model && contact.other != e.model) continue;
    if (std::find(e.except.begin(), e.except.end(), other) != e.except.end()) continue;
    return "it touched " + other + " at " + measured(contact.time) + " s";
  }
  return "";
}

std::string value_problem(const Expectation& e, const Seen& seen) {
  const auto found = seen.values.find(e.port + " " + e.member);
  if (found == seen.values.end()) return "no sample arrived";
  const auto& value = found->second;
  if (value.samples == 0) return value.problem.empty() ? "no sample arrived" : value.problem;
  if (value.not_numbers > 0)
    return "it was not a number (NaN) in " + std::to_string(value.not_numbers) + " of " + std::to_string(value.samples) + " samples";
  const auto fits = [&](double number) { return e.condition.holds([&](const auto&) { return std::optional(number); }).value(); };
  return fits(value.lowest) && fits(value.highest)
             ? ""
             : "it ran from " + measured(value.lowest) + " to " + measured(value.highest) + ", expected " + bounds(e);
}

// Reached in time, or never left.
std::string joint_problem(const Expectation& e, const Seen& seen) {
  const auto known = find_joint(seen.parts, e.model, e.joint);
  if (!known) return known.error().message;
  const auto record = seen.record.joints.find(e.joint_name());
  if (record == seen.record.joints.end()) return "it has no position: model " + base::in_quotes(e.model) + " does not move";
  const auto miss = [&](double position) {
    return std::max({0.0, e.min.value_or(position) - position, position - e.max.value_or(position)});
  };
  const RecordedJoint* nearest = nullptr;
  for (const auto& joint : record->second) {
    if (e.within > 0 && joint.time > e.within) break;
    if (e.within > 0 && miss(joint.position) == 0) return "";
    if (e.within <= 0 && miss(joint.position) > 0)
      return "it was at " + measured(joint.position) + " at " + measured(joint.time) + " s, expected " + bounds(e);
    if (nearest == nullptr || miss(joint.position) < miss(nearest->position)) nearest = &joint;
  }
  if (e.within <= 0) return "";
  if (nearest == nullptr) return "it has no position before " + base::format_number(e.within) + " s";
  return "it came no nearer than " + measured(nearest->position) + " at " + measured(nearest->time) + " s, expected " + bounds(e) +
         " within " + base::format_number(e.within) + " s";
}

std::string holds_problem(const Expectation& e, const Seen& seen) {
  const auto grip = seen.grips.find(grip_name(e.gripper, e.model));
  return grip == seen.grips.end() ? "it was not looked at" : grip->second;
}

std::string command_problem(const Expectation& e, const Seen& seen) {
  const auto found = seen.commands.find(e.command);
  if (found == seen.commands.end()) return "it was not run";
  const auto& command = found->second;
  if (!command.exit_code) return command.text;
  if (*command.exit_code == 0) return "";
  return "it ended with exit code " + std::to_string(*command.exit_code) + (command.text.empty() ? "" : ": " + command.text);
}

// What an expectation is about.
std::string subject_of(const Expectation& e) {
  switch (e.kind) {
    case Kind::value:
      return e.port + " " + e.member;
    case Kind::state:
      return "component " + e.component;
    case Kind::command:
      return "command " + base::in_quotes(e.command);
    case Kind::joint:
      return "joint " + e.joint_name();
    case Kind::holds:
      return "gripper " + e.gripper;
    default:
      return "model " + e.model;
  }
}

std::string problem_of(const Expectation& e, const Seen& seen) {
  const bool about_model = e.kind == Kind::path_length || e.kind == Kind::reach || e.kind == Kind::stay || e.kind == Kind::no_contact;
  const auto poses = seen.record.poses.find(e.model);
  if (about_model && poses == seen.record.poses.end())
    return "the world has no moving model " + base::in_quotes(e.model) + "; moving models: " + names_in(seen.record.poses);
  switch (e.kind) {
    case Kind::path_length: {
      const double length = path_length(poses->second);
      const bool fits = (!e.min || length >= *e.min) && (!e.max || length <= *e.max);
      return fits ? "" : "its path was " + measured(length) + " m long, expected " + bounds(e);
    }
    case Kind::reach:
    case Kind::stay:
      return region_problem(e, poses->second);
    case Kind::no_contact:
      return contact_problem(e, seen.record, seen.models);
    case Kind::value:
      return value_problem(e, seen);
    case Kind::state: {
      const auto state = seen.states.find(e.component);
      if (state == seen.states.end()) return "there is no such component; components: " + names_in(seen.states);
      return e.condition.holds([&](const auto&) { return recorder::state_number(state->second); }).value() ? "" : "it is " + state->second;
    }
    case Kind::joint:
      return joint_problem(e, seen);
    case Kind::holds:
      return holds_problem(e, seen);
    case Kind::command:
      return command_problem(e, seen);
  }
  return "";
}

// `place` is what a message begins with, by line and column, 0: of the whole.
Result<std::vector<Expectation>> to_expectations(const std::function<std::vector<YAML::Node>()>& load,
                                                 const std::function<std::string(int, int)>& place) {
  try {
    const auto documents = load();
    if (documents.size() > 1) return Error{place(0, 0) + "holds " + std::to_string(documents.size()) + " YAML documents, expected one"};
    auto root = documents.empty() ? YAML::Node() : documents.front();
    yaml::expect_unique_keys(root);
    if (root.IsMap() && root["expect"]) root = root["expect"];
    if (!root.IsSequence()) return Error{place(0, 0) + "must hold a list of expectations"};
    std::vector<Expectation> expectations;
    for (const auto& entry : root) {
      if (!entry.IsMap() || entry.size() != 1) fail_at(entry, "each expectation must be one NAME: {...}");
      expectations.push_back(read_one(entry.begin()->first, entry.begin()->second));
    }
    return expectations;
  } catch (const YamlFailure& failure) {
    return Error{place(failure.line, failure.column) + failure.message};
  } catch (const YAML::BadFile&) {
    return Error{place(0, 0) + "cannot be read"};
  } catch (const YAML::Exception& e) {
    return Error{place(e.mark.line + 1, e.mark.column + 1) + "is no YAML: " + e.msg};
  }
}

}  // namespace

Result<std::vector<Expectation>> read_expectations(const std::string& file) {
  if (const auto problem = base::file_problem(file); !problem.empty()) return Error{"file " + base::in_quotes(file) + ": " + problem};
  return to_expectations([&] { return YAML::LoadAllFromFile(file); },
                         [&](int line, int column) {
                           const auto at = line > 0 ? ":" + std::to_string(line) + ":" + std::to_string(column) : "";
                           return "file " + base::in_quotes(file) + at + ": ";
                         });
}

Result<std::vector<Expectation>> parse_expectations(const std::string& text, const std::string& what) {
  return to_expectations([&] { return YAML::LoadAll(text); }, [&](int, int) { return what + ": "; });
}

void SeenValue::take(double number) {
  is_over = false;
  ++samples;
  if (std::isnan(number)) {
    ++not_numbers;
    return;
  }
  const bool is_first = samples - not_numbers == 1;
  lowest = is_first ? number : std::min(lowest, number);
  highest = is_first ? number : std::max(highest, number);
  sum += number;
  last = number;
}

std::optional<double> SeenValue::mean() const {
  const auto numbers = samples - not_numbers;
  return numbers > 0 ? std::optional(sum / static_cast<double>(numbers)) : std::nullopt;
}

recorder::Expression::Lookup values_at(const RecordedPose& pose) {
  const shm::Pose at{pose.x, pose.y, pose.z, pose.qw, pose.qx, pose.qy, pose.qz};
  return [at](const auto& value) { return std::optional(member_of(at, value.member)); };
}

std::string failure_text(const Verdict& verdict) {
  return verdict.failure.empty() ? verdict.expectation + ": " + verdict.problem : verdict.failure;
}

std::vector<Verdict> judge(const std::vector<Expectation>& expectations, const Seen& seen) {
  std::vector<Verdict> verdicts;
  for (const auto& expectation : expectations) {
    Verdict verdict{expectation.text, problem_of(expectation, seen), ""};
    const auto command = seen.commands.find(expectation.command);
    if (!verdict.problem.empty() && expectation.kind == Expectation::Kind::command && command != seen.commands.end())
      verdict.details = command->second.output;
    if (!verdict.problem.empty()) {
      verdict.failure = subject_of(expectation) + ": " + verdict.problem + " (" + expectation.text + ")";
      verdict.time = failure_time(expectation, seen);
      verdict.subject = failed_object(expectation);
    }
    verdicts.push_back(std::move(verdict));
  }
  return verdicts;
}

}  // namespace tools

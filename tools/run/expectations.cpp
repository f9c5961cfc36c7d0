#include "run/expectations.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <functional>
#include <set>
#include <utility>

#include "base/plain_file.h"
#include "base/text.h"
#include "base/yaml_keys.h"
#include "run/flow_text.h"
#include "system/value_failure.h"

namespace editor {
namespace {

using base::Error;
using base::Result;
using Kind = Expectation::Kind;

const std::map<std::string, Kind> kinds = {{"path_length", Kind::path_length}, {"reach", Kind::reach}, {"stay", Kind::stay},
                                           {"no_contact", Kind::no_contact},   {"value", Kind::value}, {"state", Kind::state},
                                           {"command", Kind::command}};

const std::map<Kind, std::set<std::string>> keys = {
    {Kind::path_length, {"model", "min", "max"}},    {Kind::reach, {"model", "region", "within"}},
    {Kind::stay, {"model", "region", "within"}},     {Kind::no_contact, {"model", "except"}},
    {Kind::value, {"port", "member", "min", "max"}}, {Kind::state, {"component", "is"}}};

const std::set<std::string> states = {"Created", "Inactive", "Active", "Error"};

std::optional<double> number(const YAML::Node& node, const char* key) {
  if (!node[key]) return std::nullopt;
  const auto value = base::parse_number(node[key].Scalar());
  if (!value) throw ValueFailure{std::string(key) + " must be a finite number, got " + base::in_quotes(node[key].Scalar())};
  return value;
}

void check_keys(const YAML::Node& node, const std::string& name, Kind kind) {
  const auto& known = keys.at(kind);
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const auto& key = entry.first.Scalar();
    if (!known.contains(key))
      throw ValueFailure{name + " has no key " + base::in_quotes(key) + "; it has " +
                         base::join(std::vector<std::string>(known.begin(), known.end()), ", ")};
    if (!seen.insert(key).second) throw ValueFailure{name + " has " + key + " twice"};
  }
}

std::string without_kind(const std::string& component) {
  return component.ends_with(".rtc") ? component.substr(0, component.size() - 4) : component;
}

std::string text(const YAML::Node& node, const char* key) {
  if (!node[key] || !node[key].IsScalar() || node[key].Scalar().empty()) throw ValueFailure{std::string("needs ") + key};
  return node[key].Scalar();
}

void read_region(const YAML::Node& node, Expectation& expectation) {
  const auto region = node["region"];
  if (!region || !region.IsSequence() || region.size() != 4) throw ValueFailure{"needs region: [x1, y1, x2, y2]"};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto value = base::parse_number(region[i].Scalar());
    if (!value) throw ValueFailure{"region must hold finite numbers, got " + base::in_quotes(region[i].Scalar())};
    expectation.region[i] = *value;
  }
  if (expectation.region[0] > expectation.region[2]) std::swap(expectation.region[0], expectation.region[2]);
  if (expectation.region[1] > expectation.region[3]) std::swap(expectation.region[1], expectation.region[3]);
}

Expectation read_one(const std::string& name, const YAML::Node& node) {
  const auto kind = kinds.find(name);
  if (kind == kinds.end())
    throw ValueFailure{"unknown expectation " + base::in_quotes(name) +
                       ", expected path_length, reach, stay, no_contact, value, state or command"};
  Expectation expectation;
  expectation.kind = kind->second;
  expectation.text = name + ": " + flow_text(node);
  if (expectation.kind == Kind::command) {
    if (!node.IsScalar() || node.Scalar().empty()) throw ValueFailure{"command needs a command line"};
    expectation.command = node.Scalar();
    return expectation;
  }
  if (!node.IsMap()) throw ValueFailure{name + " needs a map"};
  check_keys(node, name, expectation.kind);
  expectation.min = number(node, "min");
  expectation.max = number(node, "max");
  if (expectation.min && expectation.max && *expectation.min > *expectation.max) throw ValueFailure{"min must not be more than max"};
  expectation.within = number(node, "within").value_or(0);
  if (node["within"] && expectation.within <= 0) throw ValueFailure{"within must be more than 0, got " + node["within"].Scalar()};
  if (expectation.kind == Kind::value) {
    expectation.port = text(node, "port");
    expectation.member = text(node, "member");
    if (const auto path = member_path(expectation.member); !path) throw ValueFailure{path.error().message};
  } else if (expectation.kind == Kind::state) {
    expectation.component = without_kind(text(node, "component"));
    expectation.state = text(node, "is");
    const auto is_it = [&](const std::string& state) { return base::equal_ignoring_case(state, expectation.state); };
    if (std::none_of(states.begin(), states.end(), is_it))
      throw ValueFailure{"is must be Created, Inactive, Active or Error, got " + base::in_quotes(expectation.state)};
  } else {
    expectation.model = text(node, "model");
  }
  if (expectation.kind == Kind::reach || expectation.kind == Kind::stay) read_region(node, expectation);
  if (expectation.kind == Kind::no_contact) {
    expectation.except = {usually_touched};
    if (node["except"]) expectation.except.clear();
    const auto except = node["except"];
    if (except && !except.IsScalar() && !except.IsSequence()) throw ValueFailure{"except must be a model or a list of models"};
    if (except && except.IsScalar()) expectation.except = {except.Scalar()};
    for (std::size_t i = 0; except && except.IsSequence() && i < except.size(); ++i) {
      if (!except[i].IsScalar()) throw ValueFailure{"except must be a model or a list of models"};
      expectation.except.push_back(except[i].Scalar());
    }
  }
  const bool bounded = expectation.kind == Kind::path_length || expectation.kind == Kind::value;
  if (bounded && !expectation.min && !expectation.max) throw ValueFailure{name + " needs min or max"};
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

bool inside(const RecordedPose& pose, const double* region) {
  return pose.x >= region[0] && pose.y >= region[1] && pose.x <= region[2] && pose.y <= region[3];
}

std::string place(const RecordedPose& pose) {
  return "(" + measured(pose.x) + ", " + measured(pose.y) + ") at " + measured(pose.time) + " s";
}

std::string region_problem(const Expectation& e, const std::vector<RecordedPose>& poses) {
  double nearest = INFINITY;
  for (const auto& pose : poses) {
    if (e.within > 0 && pose.time > e.within) break;
    const bool in = inside(pose, e.region);
    if (e.kind == Kind::reach && in) return "";
    if (e.kind == Kind::stay && !in) return "it was at " + place(pose);
    const double dx = std::max({e.region[0] - pose.x, 0.0, pose.x - e.region[2]});
    const double dy = std::max({e.region[1] - pose.y, 0.0, pose.y - e.region[3]});
    nearest = std::min(nearest, std::hypot(dx, dy));
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
  if (found == seen.values.end()) return "no sample came";
  const auto& value = found->second;
  if (value.samples == 0) return value.problem.empty() ? "no sample came" : value.problem;
  if (value.not_numbers > 0)
    return "it was not a number (NaN) in " + std::to_string(value.not_numbers) + " of " + std::to_string(value.samples) + " samples";
  const bool fits = (!e.min || value.lowest >= *e.min) && (!e.max || value.highest <= *e.max);
  return fits ? "" : "it ran from " + measured(value.lowest) + " to " + measured(value.highest) + ", expected " + bounds(e);
}

std::string command_problem(const Expectation& e, const Seen& seen) {
  const auto found = seen.commands.find(e.command);
  if (found == seen.commands.end()) return "it was not run";
  const auto& command = found->second;
  if (!command.exit_code) return command.text;
  if (*command.exit_code == 0) return "";
  return "it ended with exit code " + std::to_string(*command.exit_code) + (command.text.empty() ? "" : ": " + command.text);
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
      return fits ? "" : "it was " + measured(length) + " m, expected " + bounds(e);
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
      return base::equal_ignoring_case(state->second, e.state) ? "" : "it is " + state->second;
    }
    case Kind::command:
      return command_problem(e, seen);
  }
  return "";
}

}  // namespace

namespace {

// `place` is what a message begins with, by the line of an expectation, 0: of the whole.
Result<std::vector<Expectation>> to_expectations(const std::function<std::vector<YAML::Node>()>& load,
                                                 const std::function<std::string(int)>& place) {
  int line = 0;
  try {
    const auto documents = load();
    if (documents.size() > 1) return Error{place(0) + "holds " + std::to_string(documents.size()) + " YAML documents, expected one"};
    auto root = documents.empty() ? YAML::Node() : documents.front();
    yaml::expect_unique_keys(root);
    if (root.IsMap() && root["expect"]) root = root["expect"];
    if (!root.IsSequence()) return Error{place(0) + "must hold a list of expectations"};
    std::vector<Expectation> expectations;
    for (const auto& entry : root) {
      line = entry.Mark().line + 1;
      if (!entry.IsMap() || entry.size() != 1) throw ValueFailure{"each expectation must be one NAME: {...}"};
      expectations.push_back(read_one(entry.begin()->first.Scalar(), entry.begin()->second));
    }
    return expectations;
  } catch (const ValueFailure& failure) {
    return Error{place(line) + failure.message};
  } catch (const YAML::BadFile&) {
    return Error{place(0) + "cannot be read"};
  } catch (const YAML::Exception& e) {
    return Error{place(e.mark.line + 1) + "is no YAML: " + e.msg};
  }
}

}  // namespace

Result<std::vector<Expectation>> read_expectations(const std::string& file) {
  if (const auto problem = base::file_problem(file); !problem.empty()) return Error{"file " + base::in_quotes(file) + ": " + problem};
  return to_expectations([&] { return YAML::LoadAllFromFile(file); },
                         [&](int line) { return "file " + base::in_quotes(file) + (line > 0 ? ":" + std::to_string(line) : "") + ": "; });
}

Result<std::vector<Expectation>> parse_expectations(const std::string& text, const std::string& what) {
  return to_expectations([&] { return YAML::LoadAll(text); }, [&](int) { return what + ": "; });
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

std::vector<Verdict> judge(const std::vector<Expectation>& expectations, const Seen& seen) {
  std::vector<Verdict> verdicts;
  for (const auto& expectation : expectations) {
    Verdict verdict{expectation.text, problem_of(expectation, seen), ""};
    const auto command = seen.commands.find(expectation.command);
    if (!verdict.problem.empty() && expectation.kind == Expectation::Kind::command && command != seen.commands.end())
      verdict.details = command->second.output;
    verdicts.push_back(std::move(verdict));
  }
  return verdicts;
}

}  // namespace editor

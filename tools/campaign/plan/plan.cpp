#include "campaign/plan/plan.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "base/text.h"
#include "campaign/plan/grammar.h"
#include "run/condition_words.h"
#include "run/flow_text.h"

namespace campaign {
namespace {

constexpr std::array<std::string_view, 7> result_columns = {"row", "seed", "passed", "problem", "state", "simulated_s", "wall_s"};

using tools::fail_at;
using tools::number;
using tools::word;
using tools::words;

std::uint64_t count(const YAML::Node& node, const char* key, std::uint64_t usual) {
  return node[key] ? static_cast<std::uint64_t>(base::parse_integer(node[key].Scalar()).value_or(0)) : usual;
}

// An option of a run, within the limits of its row.
double run_number(const YAML::Node& node, const char* key, double usual, std::string_view option) {
  const auto value = number(node, key).value_or(usual);
  const auto& row = tools::run_option(option);
  if (value < row.low || value > row.high)
    fail_at(node[key], std::string(key) + " must be from " + base::format_number(row.low) + " to " + base::format_number(row.high) +
                           " s, got " + base::format_number(value));
  return value;
}

bool flag(const YAML::Node& node, const char* key, bool usual) { return node[key] ? node[key].Scalar() == "true" : usual; }

std::vector<std::string> grid(const YAML::Node& node) {
  const double from = number(node, "from").value_or(0), to = number(node, "to").value_or(0);
  if (!node["from"] || !node["to"]) fail_at(node, "a grid needs from and to");
  if (node["step"] && node["steps"]) fail_at(node, "a grid has step or steps, not both");
  const auto steps = count(node, "steps", 0);
  if (node["steps"] && steps < 1) fail_at(node["steps"], "steps must be at least 1, got " + std::to_string(steps));
  double step = number(node, "step").value_or(1);
  if (steps > 1) step = (to - from) / static_cast<double>(steps - 1);
  if (!node["steps"] && to < from) fail_at(node["to"], "to must not be less than from");
  const double all = node["steps"] ? static_cast<double>(steps) : std::floor((to - from) / step + 1e-9) + 1;
  if (all > static_cast<double>(max_rows)) fail_at(node, "a grid must have at most " + std::to_string(max_rows) + " values");
  std::vector<std::string> values;
  // A multiple of the step may carry a last bit that nobody has asked for.
  for (int i = 0; i < static_cast<int>(all); ++i) values.push_back(base::format_number(std::round((from + i * step) * 1e12) / 1e12));
  return values;
}

Axis to_axis(const YAML::Node& name, const YAML::Node& node) {
  Axis axis;
  axis.path = name.Scalar();
  if (node.IsSequence()) {
    axis.values = words(node);
    return axis;
  }
  const std::map<std::string, Range::Kind> kinds = {
      {"uniform", Range::Kind::uniform}, {"normal", Range::Kind::normal}, {"log", Range::Kind::log}};
  int ways = (node["list"] ? 1 : 0) + (node["from"] || node["to"] ? 1 : 0);
  for (const auto& [key, kind] : kinds) {
    if (!node[key]) continue;
    ++ways;
    axis.range = Range{kind, *base::parse_number(node[key][0].Scalar()), *base::parse_number(node[key][1].Scalar())};
    if (kind == Range::Kind::normal ? axis.range->b < 0 : axis.range->b < axis.range->a)
      fail_at(node[key], key + (kind == Range::Kind::normal ? ": the deviation must not be negative"
                                                            : ": the first must not be more than the second"));
    if (kind == Range::Kind::log && axis.range->a <= 0) fail_at(node[key], "log: both must be more than 0");
  }
  if (ways != 1) fail_at(node, axis.path + " needs one of list, from and to, uniform, normal, log");
  if (node["list"]) axis.values = words(node["list"]);
  if (node["from"]) axis.values = grid(node);
  return axis;
}

void read_measure(const std::string& kind, const YAML::Node& node, Measure& measure) {
  static const std::map<std::string, Measure::Kind> kinds = {{"path_length", Measure::Kind::path_length},
                                                             {"time_to", Measure::Kind::time_to},
                                                             {"clearance", Measure::Kind::clearance},
                                                             {"contacts", Measure::Kind::contacts},
                                                             {"value", Measure::Kind::value},
                                                             {"joint", Measure::Kind::joint},
                                                             {"holds", Measure::Kind::holds},
                                                             {"wall_time", Measure::Kind::wall_time}};
  static const std::map<std::string, Measure::Take> takes = {{"min", Measure::Take::min},
                                                             {"max", Measure::Take::max},
                                                             {"mean", Measure::Take::mean},
                                                             {"last", Measure::Take::last},
                                                             {"count", Measure::Take::count}};
  measure.kind = kinds.at(kind);
  measure.name = kind;
  if (!node.IsMap()) return;
  measure.model = word(node, "model");
  measure.to = words(node["to"]);
  measure.port = word(node, "port");
  measure.member = word(node, "member");
  measure.joint = word(node, "name");
  measure.gripper = word(node, "gripper");
  if (measure.kind == Measure::Kind::time_to) measure.reached = tools::to_expression(node);
  if (node["take"]) measure.take = takes.at(node["take"].Scalar());
  if (measure.kind == Measure::Kind::value) measure.name = measure.port + " " + measure.member + " " + word(node, "take");
  if (measure.kind == Measure::Kind::joint) measure.name = measure.model + "::" + measure.joint + " " + word(node, "take");
  if (measure.kind == Measure::Kind::holds) measure.name = tools::grip_name(measure.gripper, measure.model);
  measure.name = word(node, "as", measure.name);
}

std::vector<Measure> to_measures(const YAML::Node& node) {
  std::vector<Measure> measures;
  std::set<std::string> names;
  for (const auto& entry : node) {
    Measure measure;
    measure.text = tools::flow_text(entry);
    read_measure(entry.begin()->first.Scalar(), entry.begin()->second, measure);
    if (std::ranges::find(result_columns, measure.name) != result_columns.end())
      fail_at(entry, "the results have a column " + base::in_quotes(measure.name) + " already; name the measure otherwise with as");
    if (measure.kind == Measure::Kind::clearance && std::ranges::find(measure.to, measure.model) != measure.to.end())
      fail_at(entry, "cannot measure the clearance of " + base::in_quotes(measure.model) + " to itself");
    if (!names.insert(measure.name).second)
      fail_at(entry, "there are two measures " + base::in_quotes(measure.name) + "; name one with as");
    measures.push_back(measure);
  }
  return measures;
}

// What would not happen, or not be looked at, in any run.
void check_in_run(const YAML::Node& node, const char* key, double time, bool is_end_too, const Plan& plan) {
  if (time < plan.run.duration_s || (is_end_too && time == plan.run.duration_s)) return;
  fail_at(node[key] ? node[key] : node, std::string(key) + (is_end_too ? " must not be more than" : " must be less than") +
                                            " the duration of " + base::format_number(plan.run.duration_s) + " s, got " +
                                            base::format_number(time));
}

Condition to_condition_in_run(const YAML::Node& node, const Plan& plan, bool has_end = false) {
  auto condition = to_condition(node);
  if (condition.within_s && !has_end) fail_at(node["within"], "within belongs to eventually; expected after, or no time");
  check_in_run(node, "after", condition.after_s, true, plan);
  if (condition.within_s) check_in_run(node, "within", *condition.within_s, true, plan);
  if (condition.within_s && *condition.within_s < condition.after_s) fail_at(node["within"], "within must not be less than after");
  return condition;
}

Event to_event_in_run(const YAML::Node& node, const Plan& plan) {
  auto event = to_event(node);
  if (event.at_s) check_in_run(node, "at", *event.at_s, true, plan);
  if (event.when) event.when = to_condition_in_run(node["when"], plan);
  return event;
}

HuntSpace to_hunt(const YAML::Node& node, const Plan& plan) {
  HuntSpace hunt;
  if (!node || !node.IsMap()) return hunt;
  hunt.most = count(node, "most", 3);
  if (hunt.most < 1 || hunt.most > 100) fail_at(node["most"], "most must be from 1 to 100, got " + std::to_string(hunt.most));
  hunt.seed = count(node, "seed", 1);
  for (const auto& entry : node["events"]) hunt.events.push_back(to_event_in_run(entry, plan));
  for (const auto& entry : node["faults"]) {
    HuntTarget target;
    int objects = 0;
    for (const auto object :
         {Fault::Object::sensor, Fault::Object::actuator, Fault::Object::connector, Fault::Object::component, Fault::Object::naming}) {
      const auto named = entry[std::string(to_text(object))];
      if (!named) continue;
      ++objects;
      target.object = object;
      target.name = named.Scalar();
    }
    if (objects != 1) fail_at(entry, "must have one of sensor, actuator, connector, component, naming");
    const auto possible = faults_of(target.object);
    for (const auto& name : words(entry["is"])) {
      const auto kind = fault_kind(name);
      if (!kind || std::ranges::find(possible, *kind) == possible.end())
        fail_at(entry["is"], base::in_quotes(name) + " is no fault of a " + std::string(to_text(target.object)));
      target.kinds.push_back(*kind);
    }
    hunt.targets.push_back(target);
  }
  return hunt;
}

// Relative paths are relative to the plan; model:// and the like stay.
std::string in_folder(const Plan& plan, const std::string& path) {
  return path.empty() ? path : (std::filesystem::path(plan.folder()) / path).lexically_normal().string();
}

void read_expect(const YAML::Node& node, Plan& plan) {
  if (!node) return;
  if (node.IsScalar()) {
    plan.run.expectations = in_folder(plan, node.Scalar());
  } else if (node.IsSequence()) {
    YAML::Emitter block;
    block << node;
    plan.expect_text = block.c_str();
  } else {
    fail_at(node, "expect must be a file or a list of expectations");
  }
}

void read_variation(const YAML::Node& root, Plan& plan) {
  plan.seed = count(root, "seed", 1);
  plan.repeat = count(root, "repeat", 1);
  if (plan.repeat < 1) fail_at(root["repeat"], "repeat must be at least 1, got " + std::to_string(plan.repeat));
  plan.samples = count(root, "samples", 10);
  if (plan.samples < 1) fail_at(root["samples"], "samples must be at least 1, got " + std::to_string(plan.samples));
  plan.sampling_seed = count(root, "sampling_seed", 1);
  const auto sampling = word(root, "sampling", "random");
  plan.sampling = sampling == "latin" ? Plan::Sampling::latin : sampling == "sobol" ? Plan::Sampling::sobol : Plan::Sampling::random;
  for (const auto& entry : root["vary"]) {
    plan.axes.push_back(to_axis(entry.first, entry.second));
    if (plan.axes.back().path == "seed" && plan.repeat > 1) fail_at(entry.first, "seed varies already by repeat; expected one of the two");
  }
  for (const auto& entry : root["scatter"]) {
    Scatter scatter;
    scatter.models = words(entry["models"]);
    scatter.region = tools::to_region(entry["region"]);
    scatter.clearance = number(entry, "clearance").value_or(0.05);
    scatter.turns = flag(entry, "turn", true);
    plan.scatters.push_back(scatter);
  }
}

// What the plan varies is a column, too.
void check_columns(const YAML::Node& root, const Plan& plan) {
  for (const auto& measure : plan.measures) {
    if (std::ranges::find(plan.axes, measure.name, &Axis::path) != plan.axes.end())
      fail_at(root["measure"],
              "the results have a column " + base::in_quotes(measure.name) + " already; name the measure otherwise with as");
  }
}

void read_actions(const YAML::Node& root, Plan& plan) {
  for (const auto& entry : root["events"]) {
    plan.events.push_back(to_event_in_run(entry, plan));
    if (!plan.events.back().at_s && !plan.events.back().when) fail_at(entry, "an event needs at or when");
  }
  for (const auto& entry : root["faults"]) {
    plan.faults.push_back(to_fault(entry));
    check_in_run(entry, "at", plan.faults.back().at_s, false, plan);
  }
  for (const auto& entry : root["never"]) plan.never.push_back(to_condition_in_run(entry, plan));
  for (const auto& entry : root["eventually"]) plan.eventually.push_back(to_condition_in_run(entry, plan, true));
}

Plan to_plan(const YAML::Node& root, const std::string& file) {
  tools::check_shape(plan_shapes(), root, plan_shape, "plan");
  Plan plan;
  plan.file = file;
  plan.run.system = in_folder(plan, word(root, "system"));
  plan.run.world = in_folder(plan, word(root, "world"));
  plan.run.duration_s = run_number(root, "duration", plan.run.duration_s, "duration");
  read_expect(root["expect"], plan);
  read_variation(root, plan);
  plan.measures = to_measures(root["measure"]);
  check_columns(root, plan);
  read_actions(root, plan);
  plan.hunt = to_hunt(root["hunt"], plan);
  plan.run.properties = words(root["properties"]);
  plan.run.lists = words(root["for"]);
  for (const auto& path : words(root["module_path"])) plan.run.module_paths.push_back(in_folder(plan, path));
  for (const auto& path : words(root["resource_path"])) plan.run.resource_paths.push_back(in_folder(plan, path));
  plan.run.one_process_each = flag(root, "one_process_each", false);
  plan.run.hang_timeout_s = run_number(root, "hang_timeout", plan.run.hang_timeout_s, "hang-timeout");
  plan.has_pictures = flag(root, "pictures", true);
  plan.checks_invariants = flag(root, "invariants", false);
  return plan;
}

}  // namespace

std::string Plan::folder() const {
  const auto parent = std::filesystem::path(file).parent_path();
  return parent.empty() ? "." : parent.string();
}

Result<Plan> read_plan(const std::string& file) {
  const auto fail = [&](int line, int column, const std::string& what) {
    const std::string place = line > 0 ? ":" + std::to_string(line) + ":" + std::to_string(column) : "";
    return Error{"plan " + base::in_quotes(file) + place + ": " + what};
  };
  std::ifstream in(file);
  std::ostringstream text;
  if (in && in.peek() == std::ifstream::traits_type::eof()) return fail(0, 0, "is empty");
  if (!in || !(text << in.rdbuf())) return fail(0, 0, "cannot be read");
  if (text.str().size() > (16U << 20U)) return fail(0, 0, "is larger than 16 MiB");
  try {
    const auto documents = YAML::LoadAll(text.str());
    if (documents.size() != 1) return fail(0, 0, "must hold one YAML document");
    auto plan = to_plan(documents.front(), file);
    plan.text = text.str();
    return plan;
  } catch (const tools::YamlFailure& error) {
    return fail(error.line, error.column, error.message);
  } catch (const YAML::Exception& error) {
    return fail(error.mark.line + 1, error.mark.column + 1, "is no YAML: " + error.msg);
  }
}

}  // namespace campaign

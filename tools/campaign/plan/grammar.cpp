#include "campaign/plan/grammar.h"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/text.h"

namespace campaign {
namespace {

using Json = nlohmann::ordered_json;
using tools::Form;
using tools::Key;
using tools::Shape;

constexpr std::array plan_keys = {
    Key{"system", Form::text, {}, true, "RTSProfile of the system, XML or YAML; files are relative to the plan's folder"},
    Key{"world", Form::text, {}, true, "SDFormat world"},
    Key{"duration", Form::positive, {}, true, "Simulated seconds of each run"},
    Key{"expect", Form::any, {}, false, "A file with expectations as of rtse run, or the list itself"},
    Key{"seed", Form::count, {}, false, "Seed of the world's noise and of faults in the first repetition; default: 1"},
    Key{"repeat", Form::count, {}, false, "Number of runs of each combination, each with the next seed; default: 1"},
    Key{"vary", Form::named, "vary", false, "Parameter paths and the values they take"},
    Key{"scatter", Form::maps, "scatter", false, "Models that are placed at random without touching anything"},
    Key{"samples", Form::count, {}, false, "Number of samples of the ranges (uniform, normal, log); default: 10"},
    Key{"sampling", Form::words, "random latin sobol", false, "Sampling method; default: random"},
    Key{"sampling_seed", Form::count, {}, false, "Seed of the sampling and of scatter; default: 1"},
    Key{"measure", Form::list, "measure", false, "Numbers to take from each run"},
    Key{"events", Form::maps, "event", false, "Actions at a simulated time or on a condition"},
    Key{"faults", Form::maps, "fault", false, "Faults to inject, and their times"},
    Key{"never", Form::maps, "condition", false, "Conditions that must never be true"},
    Key{"eventually", Form::maps, "condition", false, "Conditions that must become true"},
    Key{"hunt", Form::map, "hunt", false, "Faults and events that a hunt can try"},
    Key{"for", Form::texts, {}, false, "Lists of a system that is a template: NAME=LIST, as --for of rtse run"},
    Key{"properties", Form::texts, {}, false, "Properties of components at their creation: INSTANCE:KEY=VALUE"},
    Key{"module_path", Form::texts, {}, false, "Folders with modules of components"},
    Key{"resource_path", Form::texts, {}, false, "Folders with models"},
    Key{"one_process_each", Form::flag, {}, false, "Start one process per component; default: one for all"},
    Key{"hang_timeout", Form::positive, {}, false, "Timeout of one tick [wall-clock s]; default: 30"},
    Key{"invariants", Form::flag, {}, false, "Fail if a port sends a NaN; default: false, and true in a hunt"},
    Key{"pictures", Form::flag, {}, false, "Save an image of failed runs; default: true"},
};

constexpr std::array vary_keys = {
    Key{"list", Form::values, {}, false, "These values, one after the other"},
    Key{"from", Form::number, {}, false, "First value of a grid"},
    Key{"to", Form::number, {}, false, "Last value of a grid"},
    Key{"step", Form::positive, {}, false, "Distance of the values of a grid; default: 1"},
    Key{"steps", Form::count, {}, false, "Number of values of a grid, instead of step"},
    Key{"uniform", Form::pair, {}, false, "Least and greatest value of a range"},
    Key{"normal", Form::pair, {}, false, "Mean and standard deviation"},
    Key{"log", Form::pair, {}, false, "Least and greatest value; the logarithm is uniform"},
};

constexpr std::array scatter_keys = {
    Key{"models", Form::texts, {}, true, "Models of the world"},
    Key{"region", Form::region, {}, true, "Region for their centres [m]"},
    Key{"clearance", Form::number, {}, false, "Least distance between them and all other models [m]; default: 0.05"},
    Key{"turn", Form::flag, {}, false, "Also set a random yaw; default: true"},
};

constexpr std::array measure_keys = {
    Key{"path_length", Form::map, "of_model", false, "Path length of a model [m]"},
    Key{"time_to", Form::map, "time_to", false, "Seconds until a model is in a region"},
    Key{"clearance", Form::map, "clearance", false,
        "Smallest distance between a model and others [m], seen from above, ten times a second"},
    Key{"contacts", Form::map, "of_model", false, "Number of times that a model started to touch something other than the ground"},
    Key{"value", Form::map, "value", false, "Member of the samples of a port"},
    Key{"joint", Form::map, "joint", false, "Position of a joint [rad or m], ten times a second"},
    Key{"holds", Form::map, "holds", false, "1 if a gripper holds a model at the end, else 0"},
    Key{"wall_time", Form::map, "named_only", false, "Duration of the run [wall-clock s]"},
};

constexpr std::array of_model_keys = {
    Key{"model", Form::text, {}, true, "Model of the world"},
    Key{"as", Form::text, {}, false, "Name of the number in the results"},
};
constexpr std::array time_to_keys = {
    Key{"model", Form::text, {}, true, "Model of the world"},
    Key{"region", Form::region, {}, true, "Corners [m]"},
    Key{"as", Form::text, {}, false, "Name of the number in the results"},
};
constexpr std::array clearance_keys = {
    Key{"model", Form::text, {}, true, "Model of the world"},
    Key{"to", Form::texts, {}, false, "Only to these models"},
    Key{"as", Form::text, {}, false, "Name of the number in the results"},
};
constexpr std::array value_keys = {
    Key{"port", Form::text, {}, true, "INSTANCE:PORT, an OutPort"},
    Key{"member", Form::text, {}, true, "Path in the sample, like data.vx or ranges[0]"},
    Key{"take", Form::words, "min max mean last count", true, "Which number of all samples"},
    Key{"as", Form::text, {}, false, "Name of the number in the results"},
};
constexpr std::array joint_keys = {
    Key{"model", Form::text, {}, true, "Model of the world"},
    Key{"name", Form::text, {}, true, "Joint of the model"},
    Key{"take", Form::words, "min max mean last", true, "Which number of all positions"},
    Key{"as", Form::text, {}, false, "Name of the number in the results"},
};
constexpr std::array holds_keys = {
    Key{"gripper", Form::text, {}, true, "MODEL::GRIPPER, or a model with one gripper"},
    Key{"model", Form::text, {}, true, "Model that it holds"},
    Key{"as", Form::text, {}, false, "Name of the number in the results"},
};
constexpr std::array named_only_keys = {Key{"as", Form::text, {}, false, "Name of the number in the results"}};

constexpr std::array condition_keys = {
    Key{"port", Form::text, {}, false, "INSTANCE:PORT, an OutPort; with member, and min or max"},
    Key{"member", Form::text, {}, false, "Path in the sample"},
    Key{"min", Form::number, {}, false, "The latest value is at least this"},
    Key{"max", Form::number, {}, false, "The latest value is at most this"},
    Key{"model", Form::text, {}, false, "Model of the world; with region, or touches"},
    Key{"region", Form::region, {}, false, "The model is in there [m]"},
    Key{"touches", Form::text, {}, false, "The model touches this one; any: another one than the ground"},
    Key{"component", Form::text, {}, false, "Component of the system; with is"},
    Key{"is", Form::words, "Created Inactive Active Error", false, "The component is in this state"},
    Key{"after", Form::number, {}, false, "Counts only from this simulated time on [s]"},
    Key{"within", Form::positive, {}, false, "eventually: until this simulated time [s]; default: the end"},
};

constexpr std::array event_keys = {
    Key{"at", Form::number, {}, false, "Simulated time [s]"},
    Key{"when", Form::map, "condition", false, "The first moment at which this is true, looked at ten times a second"},
    Key{"spawn", Form::map, "spawn", false, "Adds a model"},
    Key{"delete", Form::text, {}, false, "Removes a model"},
    Key{"push", Form::map, "push", false, "Pushes a model"},
    Key{"wrench", Form::map, "wrench", false, "Pushes a link by a force and a torque"},
    Key{"joint_force", Form::map, "joint_force", false, "Pushes a joint, beside what its motor does"},
    Key{"pose", Form::map, "pose", false, "Puts a model somewhere"},
    Key{"set", Form::map, "set", false, "Sets a configuration parameter"},
    Key{"activate", Form::text, {}, false, "Activates a component"},
    Key{"deactivate", Form::text, {}, false, "Deactivates a component"},
    Key{"reset", Form::text, {}, false, "Resets a component that is in its error state"},
    Key{"connect", Form::text, {}, false, "Makes a connection of the system again, by its id or name"},
    Key{"disconnect", Form::text, {}, false, "Ends a connection of the system, by its id or name"},
    Key{"command", Form::text, {}, false, "Runs a command line"},
};
constexpr std::array spawn_keys = {
    Key{"model", Form::text, {}, true, "SDF file, model folder or model://NAME"},
    Key{"name", Form::text, {}, false, "Name in the world"},
    Key{"pose", Form::values, {}, false, "X Y YAW, X Y Z YAW, or X Y Z ROLL PITCH YAW [m, rad]"},
};
constexpr std::array push_keys = {
    Key{"model", Form::text, {}, true, "Model or MODEL::LINK"},
    Key{"force", Form::values, {}, true, "FX FY FZ [N], and TX TY TZ [N m]"},
    Key{"for", Form::positive, {}, false, "Simulated seconds; default: one step"},
};
constexpr std::array wrench_keys = {
    Key{"model", Form::text, {}, true, "Model or MODEL::LINK, at its centre of mass"},
    Key{"force", Form::values, {}, false, "FX FY FZ [N], world frame; default: 0 0 0"},
    Key{"torque", Form::values, {}, false, "TX TY TZ [N m], world frame; default: 0 0 0"},
    Key{"for", Form::positive, {}, false, "Simulated seconds; default: one step"},
    Key{"persistent", Form::flag, {}, false, "Push until the next one of the link that is persistent"},
    Key{"clear", Form::flag, {}, false, "End what is persistent"},
};
constexpr std::array joint_force_keys = {
    Key{"model", Form::text, {}, true, "Model of the world"},
    Key{"joint", Form::text, {}, true, "Joint of the model that turns or slides"},
    Key{"force", Form::number, {}, false, "Torque about or force along its axis [N m or N]"},
    Key{"for", Form::positive, {}, false, "Simulated seconds; default: one step"},
    Key{"persistent", Form::flag, {}, false, "Push until the next one of the joint that is persistent"},
    Key{"clear", Form::flag, {}, false, "End what is persistent"},
};
constexpr std::array pose_keys = {
    Key{"model", Form::text, {}, true, "Model of the world"},
    Key{"to", Form::values, {}, true, "X Y YAW, X Y Z YAW, or X Y Z ROLL PITCH YAW [m, rad]"},
};
constexpr std::array set_keys = {
    Key{"component", Form::text, {}, true, "Component of the system"},
    Key{"parameter", Form::text, {}, true, "Parameter of its active configuration set"},
    Key{"value", Form::text, {}, true, "New value"},
};

constexpr std::array fault_keys = {
    Key{"at", Form::number, {}, true, "Simulated time [s]"},
    Key{"for", Form::positive, {}, false, "Duration [simulated s]; default: to the end"},
    Key{"sensor", Form::text, {}, false, "iface of a sensor; with is"},
    Key{"actuator", Form::text, {}, false, "iface of a drive or joints, or IFACE::JOINT; with is"},
    Key{"connector", Form::text, {}, false, "Id or name of a connection of the system; with is"},
    Key{"component", Form::text, {}, false, "Component of the system; with is"},
    Key{"naming", Form::words, "gone", false, "The name server does not respond"},
    Key{"is", Form::words, "off stuck bias noise missing latency dropout weak drop delay duplicate reorder error exception slow hang kill",
        false, "Kind of the fault"},
    Key{"amount",
        Form::number,
        {},
        false,
        "bias, noise: in the sensor's unit; missing, dropout, drop, duplicate, reorder: a fraction; latency, delay: ticks, samples; weak: "
        "fraction of the strength that is left; slow: seconds of real time a tick"},
};

constexpr std::array hunt_keys = {
    Key{"faults", Form::maps, "hunt_fault", false, "Faults to try; default: all that the system allows"},
    Key{"events", Form::maps, "event", false, "Events to try, at any time"},
    Key{"most",
        Form::count,
        {},
        false,
        "Maximum number of faults and events of one run; a deactivation and the activation after it count as one; default: 3"},
    Key{"seed", Form::count, {}, false, "Seed of the hunt; default: 1"},
};
constexpr std::array hunt_fault_keys = {
    Key{"sensor", Form::text, {}, false, "iface of a sensor"},
    Key{"actuator", Form::text, {}, false, "iface of a drive or joints, or IFACE::JOINT"},
    Key{"connector", Form::text, {}, false, "Id or name of a connection of the system"},
    Key{"component", Form::text, {}, false, "Component of the system"},
    Key{"naming", Form::words, "gone", false, "The name server does not respond"},
    Key{"is", Form::texts, {}, false, "Kinds of faults to try; default: all that fit"},
};

constexpr std::array shapes = {
    Shape{plan_shape, plan_keys},
    Shape{"vary", vary_keys},
    Shape{"scatter", scatter_keys},
    Shape{"measure", measure_keys},
    Shape{"of_model", of_model_keys},
    Shape{"time_to", time_to_keys},
    Shape{"clearance", clearance_keys},
    Shape{"value", value_keys},
    Shape{"named_only", named_only_keys},
    Shape{"condition", condition_keys},
    Shape{"event", event_keys},
    Shape{"spawn", spawn_keys},
    Shape{"push", push_keys},
    Shape{"wrench", wrench_keys},
    Shape{"joint_force", joint_force_keys},
    Shape{"pose", pose_keys},
    Shape{"set", set_keys},
    Shape{"joint", joint_keys},
    Shape{"holds", holds_keys},
    Shape{"fault", fault_keys},
    Shape{"hunt", hunt_keys},
    Shape{"hunt_fault", hunt_fault_keys},
};

Json reference(std::string_view name) { return {{"$ref", "#/$defs/" + std::string(name)}}; }

Json numbers(std::size_t count) { return {{"type", "array"}, {"items", {{"type", "number"}}}, {"minItems", count}, {"maxItems", count}}; }

Json scalars() { return {{"type", "array"}, {"items", {{"type", {"string", "number", "boolean"}}}}, {"minItems", 1}}; }

Json schema_of(const Key& key) {
  switch (key.form) {
    case Form::text:
      return {{"type", {"string", "number", "boolean"}}};
    case Form::number:
      return {{"type", "number"}};
    case Form::positive:
      return {{"type", "number"}, {"exclusiveMinimum", 0}};
    case Form::fraction:
      return {{"type", "number"}, {"minimum", 0}, {"maximum", 1}};
    case Form::count:
      return {{"type", "integer"}, {"minimum", 0}};
    case Form::flag:
      return {{"type", "boolean"}};
    case Form::pair:
      return numbers(2);
    case Form::region:
      return numbers(4);
    case Form::values:
      return scalars();
    case Form::texts:
      return {{"anyOf", {Json{{"type", {"string", "number"}}}, scalars()}}};
    case Form::words: {
      Json values = base::split_list(key.of, ' ');
      if (std::ranges::find(values, "off") != values.end()) values.push_back(false);  // what editors read of an off without quotes
      return {{"enum", values}};
    }
    case Form::any:
      return Json::object();
    case Form::map:
      return reference(key.of);
    case Form::one: {
      auto json = reference(key.of);
      json["minProperties"] = json["maxProperties"] = 1;
      return json;
    }
    case Form::list: {
      auto item = reference(key.of);
      item["minProperties"] = item["maxProperties"] = 1;
      return {{"type", "array"}, {"items", item}};
    }
    case Form::maps:
      return {{"type", "array"}, {"items", reference(key.of)}};
    case Form::named:
      return {{"type", "object"}, {"additionalProperties", {{"anyOf", {scalars(), reference(key.of)}}}}};
  }
  return Json::object();
}

Json schema_of(const Shape& shape) {
  Json properties = Json::object();
  std::vector<std::string> needed;
  for (const Key& key : shape.keys) {
    auto json = schema_of(key);
    json["description"] = std::string(key.meaning);
    properties[std::string(key.name)] = json;
    if (key.is_needed) needed.emplace_back(key.name);
  }
  Json json{{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
  if (!needed.empty()) json["required"] = needed;
  return json;
}

}  // namespace

tools::Shapes plan_shapes() { return shapes; }

Json plan_schema() {
  Json json{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", "Plan of a campaign (rtse sweep, rtse hunt)"}};
  json.update(schema_of(tools::shape(shapes, plan_shape)));
  auto& definitions = json["$defs"] = Json::object();
  for (const Shape& one : shapes) {
    if (one.name != plan_shape) definitions[std::string(one.name)] = schema_of(one);
  }
  return json;
}

}  // namespace campaign

#include "campaign/plan/actions.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "run/condition_words.h"
#include "run/flow_text.h"

namespace campaign {
namespace {

using tools::fail_at;
using tools::word;
using Kind = Fault::Kind;
using Object = Fault::Object;

constexpr std::array<std::string_view, 5> object_names = {"sensor", "actuator", "connector", "component", "naming"};

struct FaultRow {
  std::string_view name;
  Kind kind;
  std::array<bool, 5> fits;               // by object
  std::optional<double> amount{};         // usual
  double min_amount = 0, max_amount = 0;  // of the amount
};

constexpr std::array fault_rows = {
    FaultRow{"off", Kind::off, {true, false, false, false, false}},
    FaultRow{"stuck", Kind::stuck, {true, true, false, false, false}},
    FaultRow{"bias", Kind::bias, {true, false, false, false, false}, 0.5, -1e6, 1e6},
    FaultRow{"noise", Kind::noise, {true, false, false, false, false}, 0.1, 0, 1e6},
    FaultRow{"missing", Kind::missing, {true, false, false, false, false}, 0.2, 0, 1},
    FaultRow{"latency", Kind::latency, {true, false, false, false, false}, 5, 1, 1000},
    FaultRow{"dropout", Kind::dropout, {true, false, false, false, false}, 0.5, 0, 1},
    FaultRow{"weak", Kind::weak, {false, true, false, false, false}, 0.5, 0, 1},
    FaultRow{"drop", Kind::drop, {false, false, true, false, false}, 0.5, 0, 1},
    FaultRow{"delay", Kind::delay, {false, false, true, false, false}, 3, 1, 1000},
    FaultRow{"duplicate", Kind::duplicate, {false, false, true, false, false}, 0.5, 0, 1},
    FaultRow{"reorder", Kind::reorder, {false, false, true, false, false}, 0.5, 0, 1},
    FaultRow{"error", Kind::error, {false, false, false, true, false}},
    FaultRow{"exception", Kind::exception, {false, false, false, true, false}},
    FaultRow{"slow", Kind::slow, {false, false, false, true, false}, 0.01, 0, 60},
    FaultRow{"hang", Kind::hang, {false, false, false, true, false}},
    FaultRow{"kill", Kind::kill, {false, false, false, true, false}},
    FaultRow{"gone", Kind::gone, {false, false, false, false, true}},
};

const FaultRow& row_of(Kind kind) {
  return *std::ranges::find_if(fault_rows, [&](const FaultRow& row) { return row.kind == kind; });
}

std::vector<std::string> numbers_of(const YAML::Node& node, const char* what, std::initializer_list<std::size_t> sizes,
                                    const char* expected) {
  std::vector<std::string> numbers;
  for (const auto& one : node) {
    const auto number = base::parse_number(one.Scalar());
    if (!number) fail_at(one, std::string(what) + " must hold finite numbers, got " + base::in_quotes(one.Scalar()));
    numbers.push_back(base::format_number(*number));
  }
  if (std::ranges::find(sizes, numbers.size()) == sizes.end())
    fail_at(node, std::string(what) + " must be " + expected + ", got " + std::to_string(numbers.size()) +
                      (numbers.size() == 1 ? " number" : " numbers"));
  return numbers;
}

// Of a push, as the simulator takes it.
void check_push(const YAML::Node& node, const char* what, const std::vector<std::string>& numbers) {
  constexpr double largest = 1e7;  // [N], [N m]
  for (const auto& number : numbers) {
    if (!(std::abs(*base::parse_number(number)) < largest)) fail_at(node, std::string(what) + " must be below 1e7, got " + number);
  }
}

struct EventRow {
  const char* key;
  Event::Kind kind;
};
constexpr std::array event_rows = {
    EventRow{"spawn", Event::Kind::spawn},
    EventRow{"delete", Event::Kind::remove},
    EventRow{"push", Event::Kind::push},
    EventRow{"wrench", Event::Kind::wrench},
    EventRow{"joint_force", Event::Kind::joint_force},
    EventRow{"pose", Event::Kind::pose},
    EventRow{"set", Event::Kind::set},
    EventRow{"activate", Event::Kind::activate},
    EventRow{"deactivate", Event::Kind::deactivate},
    EventRow{"reset", Event::Kind::reset},
    EventRow{"connect", Event::Kind::connect},
    EventRow{"disconnect", Event::Kind::disconnect},
    EventRow{"command", Event::Kind::command},
};

constexpr const char* pose_words = "x y yaw, x y z yaw or x y z roll pitch yaw";

// How long it pushes. True: `clear` ends those that stay, so that it has no numbers.
bool read_push_time(const YAML::Node& what, Event& event) {
  const auto is_set = [&](const char* key) { return what[key] && what[key].Scalar() == "true"; };
  const bool clears = is_set("clear");
  event.stays = clears || is_set("persistent");
  if (what["for"] && event.stays) fail_at(what["for"], std::string("for does not go with ") + (clears ? "clear" : "persistent"));
  if (what["for"]) event.duration_s = *base::parse_number(what["for"].Scalar());
  for (const char* key : {"force", "torque", "persistent"}) {
    if (clears && what[key]) fail_at(what[key], std::string(key) + " does not go with clear");
  }
  return clears;
}

void read_wrench(const YAML::Node& what, Event& event) {
  event.target = word(what, "model");
  const bool clears = read_push_time(what, event);
  if (!clears && !what["force"] && !what["torque"]) fail_at(what, "wrench needs force, torque or clear");
  for (const char* key : {"force", "torque"}) {
    const auto numbers = what[key] ? numbers_of(what[key], key, {3}, "3 numbers") : std::vector<std::string>(3, "0");
    check_push(what[key] ? what[key] : what, key, numbers);
    event.numbers.insert(event.numbers.end(), numbers.begin(), numbers.end());
  }
}

void read_joint_force(const YAML::Node& what, Event& event) {
  event.target = word(what, "model") + "::" + word(what, "joint");
  const bool clears = read_push_time(what, event);
  if (!clears && !what["force"]) fail_at(what, "joint_force needs force or clear");
  event.numbers = {clears ? "0" : base::format_number(*base::parse_number(what["force"].Scalar()))};
  check_push(clears ? what : what["force"], "force", event.numbers);
}

void read_details(const YAML::Node& what, Event& event) {
  switch (event.kind) {
    case Event::Kind::spawn:
      event.target = word(what, "model");
      event.name = word(what, "name");
      if (what["pose"]) event.numbers = numbers_of(what["pose"], "pose", {3, 4, 6}, pose_words);
      break;
    case Event::Kind::push:
      event.target = word(what, "model");
      event.numbers = numbers_of(what["force"], "force", {3, 6}, "3 numbers of a force or 6 of a force and a torque");
      check_push(what["force"], "force", event.numbers);
      if (what["for"]) event.duration_s = *base::parse_number(what["for"].Scalar());
      break;
    case Event::Kind::wrench:
      read_wrench(what, event);
      break;
    case Event::Kind::joint_force:
      read_joint_force(what, event);
      break;
    case Event::Kind::pose:
      event.target = word(what, "model");
      event.numbers = numbers_of(what["to"], "to", {3, 4, 6}, pose_words);
      break;
    case Event::Kind::set:
      event.target = word(what, "component");
      event.name = word(what, "parameter");
      event.value = word(what, "value");
      break;
    default:
      event.target = what.Scalar();
      break;
  }
}

}  // namespace

std::string_view to_text(Object object) { return object_names[static_cast<std::size_t>(object)]; }
std::string_view to_text(Kind kind) { return row_of(kind).name; }

std::optional<Kind> fault_kind(std::string_view name) {
  const auto row = std::ranges::find_if(fault_rows, [&](const FaultRow& one) { return one.name == name; });
  return row == fault_rows.end() ? std::nullopt : std::optional(row->kind);
}

std::vector<Kind> faults_of(Object object) {
  std::vector<Kind> kinds;
  for (const FaultRow& row : fault_rows) {
    if (row.fits[static_cast<std::size_t>(object)]) kinds.push_back(row.kind);
  }
  return kinds;
}

std::optional<double> usual_amount(Kind kind) { return row_of(kind).amount; }

std::string Fault::text() const {
  std::string text = "{at: " + base::format_number(at_s);
  if (for_s) text += ", for: " + base::format_number(*for_s);
  if (object == Object::naming) return text + ", naming: gone}";
  text += ", " + std::string(to_text(object)) + ": \"" + target + "\", is: " + std::string(to_text(kind));
  if (usual_amount(kind)) text += ", amount: " + base::format_number(amount);
  return text + "}";
}

void set_spawned(Event& event, const std::string& file) {
  event.target = file;
  auto node = YAML::Load(event.text);
  node["spawn"]["model"] = file;
  event.text = tools::flow_text(node);
}

Condition to_condition(const YAML::Node& node) {
  return {tools::flow_text(node), tools::to_expression(node), tools::number(node, "after").value_or(0), tools::number(node, "within")};
}

Event to_event(const YAML::Node& node) {
  Event event;
  event.text = tools::flow_text(node);
  if (node["at"] && node["when"]) fail_at(node, "an event must not have both at and when");
  if (node["at"]) event.at_s = *base::parse_number(node["at"].Scalar());
  if (event.at_s && *event.at_s < 0) fail_at(node["at"], "at must not be negative");
  if (node["when"]) event.when = to_condition(node["when"]);
  int actions = 0;
  for (const EventRow& row : event_rows) {
    if (!node[row.key]) continue;
    ++actions;
    event.kind = row.kind;
    read_details(node[row.key], event);
  }
  if (actions != 1) fail_at(node, "an event must do exactly one thing, such as push, set or command");
  return event;
}

Fault to_fault(const YAML::Node& node) {
  Fault fault;
  int objects = 0;
  for (std::size_t i = 0; i < object_names.size(); ++i) {
    const auto named = node[std::string(object_names[i])];
    if (!named) continue;
    ++objects;
    fault.object = static_cast<Object>(i);
    fault.target = named.Scalar();
  }
  if (objects != 1) fail_at(node, "a fault must have one of sensor, actuator, connector, component, naming");
  fault.at_s = *base::parse_number(node["at"].Scalar());
  if (fault.at_s < 0) fail_at(node["at"], "at must not be negative");
  if (node["for"]) fault.for_s = base::parse_number(node["for"].Scalar());
  fault.kind = Kind::gone;
  if (fault.object != Object::naming) {
    if (!node["is"]) fail_at(node, "a fault needs is");
    fault.kind = *fault_kind(node["is"].Scalar());
  }
  const auto& row = row_of(fault.kind);
  if (!row.fits[static_cast<std::size_t>(fault.object)]) {
    std::vector<std::string> names;
    for (const auto kind : faults_of(fault.object)) names.emplace_back(to_text(kind));
    fail_at(node["is"], "a fault of a " + std::string(to_text(fault.object)) + " must be " + base::join(names, ", "));
  }
  if (node["amount"] && !row.amount) fail_at(node["amount"], std::string(row.name) + " has no amount");
  fault.amount = node["amount"] ? *base::parse_number(node["amount"].Scalar()) : row.amount.value_or(0);
  if (row.amount && (fault.amount < row.min_amount || fault.amount > row.max_amount))
    fail_at(node["amount"], "amount of " + std::string(row.name) + " must be from " + base::format_number(row.min_amount) + " to " +
                                base::format_number(row.max_amount) + ", got " + base::format_number(fault.amount));
  const bool is_count = fault.kind == Fault::Kind::latency || fault.kind == Fault::Kind::delay;
  if (is_count && fault.amount != std::floor(fault.amount))
    fail_at(node["amount"],
            "amount of " + std::string(row.name) + " must be a whole number of samples, got " + base::format_number(fault.amount));
  return fault;
}

}  // namespace campaign

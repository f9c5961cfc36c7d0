#include "campaign/run/subject_checks.h"

#include <algorithm>
#include <set>
#include <vector>

#include "base/text.h"
#include "run/expectations.h"
#include "run/run_system.h"
#include "system/value_codec.h"

namespace campaign {
namespace {

using tools::Expectation;

// COMPONENT:PORT of a condition or a measure; empty: good. The problem says what is there.
std::string port_problem(const tools::SavedSystem& system, const std::string& port) {
  const auto colon = port.find(':');
  if (colon == std::string::npos || colon + 1 == port.size()) return "port " + base::in_quotes(port) + ": expected COMPONENT:PORT";
  const auto* component = system.component(port.substr(0, colon));
  if (component == nullptr || component->data_ports.empty()) return "";
  std::vector<std::string> names;
  for (const auto& one : component->data_ports) names.push_back(one.name.substr(one.name.find('.') + 1));
  if (std::ranges::find(names, port.substr(colon + 1)) != names.end()) return "";
  return "component " + component->instance + " has no port " + base::in_quotes(port.substr(colon + 1)) +
         " in the profile; ports: " + base::join(names, ", ");
}

// Of a number that it sends, as far as the profile's connections tell; empty: good.
std::string value_problem(const tools::SavedSystem& system, const std::string& port, const std::string& member) {
  const auto path = tools::member_path(member);
  if (!path) return path.error().message;
  const auto is_at = [&](const tools::SavedTarget& end) {
    return end.instance + ":" + end.port_name.substr(end.port_name.find('.') + 1) == port;
  };
  bool is_read = false;
  for (const auto& connector : system.connectors) {
    if (!connector.is_data) continue;
    if (is_at(connector.source)) {
      const auto problem = tools::member_problem(connector.data_type, *path);
      return problem.empty() ? "" : "port " + base::in_quotes(port) + " sends no number " + base::in_quotes(member) + "; it has " + problem;
    }
    is_read = is_read || is_at(connector.target);
  }
  return is_read ? "port " + base::in_quotes(port) + " is not an OutPort, so it has no values" : "";
}

class SubjectChecks {
 public:
  SubjectChecks(const Plan& plan, const tools::SavedSystem& system, const std::map<std::string, SurveyedModel>& models)
      : plan_(plan), system_(system), models_(models) {
    for (const auto* events : {&plan.events, &plan.hunt.events}) {
      for (const auto& event : *events) {
        if (event.kind != Event::Kind::spawn) continue;
        spawned_.insert(event.name);
        has_unnamed_ = has_unnamed_ || event.name.empty();
      }
    }
  }

  Result<void> check() {
    for (const auto& measure : plan_.measures) check_measure(measure);
    for (const auto& text : plan_.run.properties) {
      const auto property = tools::parse_property(text);
      if (!property) return property.error();
      check_component("properties", property->instance);
    }
    if (!plan_.run.expectations.empty() || !plan_.expect_text.empty()) {
      const auto expectations = plan_.run.expectations.empty()
                                    ? tools::parse_expectations(plan_.expect_text, "plan " + base::in_quotes(plan_.file) + ": expect")
                                    : tools::read_expectations(plan_.run.expectations);
      if (!expectations) return expectations.error();
      for (const auto& expectation : *expectations) check_expectation(expectation);
    }
    for (const auto& event : plan_.events) check_event("events", event);
    for (const auto& event : plan_.hunt.events) check_event("hunt: events", event);
    for (const auto& fault : plan_.faults) check_target("faults", fault.object, fault.target);
    for (const auto& target : plan_.hunt.targets) check_target("hunt: faults", target.object, target.name);
    for (const auto& condition : plan_.never) check_values("never", condition.expression);
    for (const auto& condition : plan_.eventually) check_values("eventually", condition.expression);
    return problem_.empty() ? Result<void>() : Error{problem_};
  }

 private:
  void fail(const std::string& where, const std::string& what) {
    if (problem_.empty()) problem_ = "plan " + base::in_quotes(plan_.file) + ": " + where + ": " + what;
  }

  template <class Items>
  static std::string listed(const Items& items) {
    const std::vector<std::string> names(items.begin(), items.end());
    return names.empty() ? "none" : base::join(names, ", ");
  }

  // Of a model, a link in it or an iface. What is spawned without a name may have any.
  void check_model(const std::string& where, const std::string& name, bool must_move = false) {
    const auto model_name = name.substr(0, name.find("::"));
    if (name.empty() || name == "any" || has_unnamed_ || spawned_.contains(model_name)) return;
    const auto found = models_.find(model_name);
    if (found != models_.end() && !(must_move && found->second.is_static)) return;
    std::set<std::string> names;
    for (const auto& [one, model] : models_) {
      if (!must_move || !model.is_static) names.insert(one);
    }
    if (!must_move) names.insert(spawned_.begin(), spawned_.end());
    const std::string kind = must_move ? "moving model" : "model";
    fail(where, "the world has no " + kind + " " + base::in_quotes(name) + "; " + kind + "s: " + listed(names));
  }

  bool is_static(const std::string& name) const {
    const auto model = models_.find(name.substr(0, name.find("::")));
    return !has_unnamed_ && model != models_.end() && model->second.is_static && !spawned_.contains(model->first);
  }

  void check_component(const std::string& where, const std::string& name) {
    if (name.empty() || system_.component(name)) return;
    std::vector<std::string> names;
    for (const auto& component : system_.components) names.push_back(component.instance);
    fail(where, "the system has no component " + base::in_quotes(name) + "; components: " + listed(names));
  }

  void check_connection(const std::string& where, const std::string& name) {
    std::vector<std::string> names;
    for (const auto& connector : system_.connectors) {
      if (connector.id == name || connector.name == name) return;
      names.push_back(connector.id);
    }
    fail(where, "the system has no connection " + base::in_quotes(name) + "; connections: " + listed(names));
  }

  void check_faulty_connection(const std::string& where, const std::string& name) {
    check_connection(where, name);
    for (const auto& connector : system_.connectors) {
      if (connector.id != name && connector.name != name) continue;
      if (!connector.is_data || base::equal_ignoring_case(connector.dataflow_type, "pull"))
        fail(where, "connection " + base::in_quotes(name) + " carries " + (connector.is_data ? "data by pull" : "service calls") +
                        "; only data that are pushed can be dropped, delayed, doubled or reordered");
    }
  }

  void check_port(const std::string& where, const std::string& port, const std::string& member) {
    if (port.empty()) return;
    check_component(where, port.substr(0, port.find(':')));
    if (const auto problem = port_problem(system_, port); !problem.empty()) return fail(where, problem);
    if (const auto problem = value_problem(system_, port, member); !problem.empty()) fail(where, problem);
  }

  void check_parameter(const std::string& where, const Event& event) {
    const auto* component = system_.component(event.target);
    if (component == nullptr) return check_component(where, event.target);
    std::set<std::string> known;
    for (const auto& set : component->configuration_sets) {
      if (set.is_hidden()) continue;
      for (const auto& [key, value] : set.values) known.insert(key);
    }
    if (known.empty() || known.contains(event.name)) return;  // a profile need not list any
    fail(where, "component " + event.target + " has no parameter " + base::in_quotes(event.name) + "; parameters: " + listed(known));
  }

  // `must_move`: the models.
  void check_values(const std::string& where, const recorder::Expression& expression, bool must_move = false) {
    using Kind = recorder::Expression::Value::Kind;
    for (const auto& value : expression.values()) {
      if (value.kind == Kind::state) check_component(where, value.name);
      if (value.kind == Kind::pose || value.kind == Kind::touches) check_model(where, value.name, must_move);
      if (value.kind == Kind::touches) check_model(where, value.member);
      if (value.kind == Kind::port) check_port(where, value.name, value.member);
    }
  }

  void check_measure(const Measure& measure) {
    for (const auto& model : measure.to) check_model("measure", model);
    const bool must_move = measure.kind == Measure::Kind::path_length || measure.kind == Measure::Kind::time_to;
    check_model("measure", measure.model, must_move);
    check_port("measure", measure.port, measure.member);
    if (measure.kind == Measure::Kind::joint) check_joint("measure", measure.model, measure.joint);
    if (measure.kind == Measure::Kind::holds) check_gripper("measure", measure.gripper);
  }

  void check_expectation(const Expectation& expectation) {
    const auto where = "expect: " + expectation.text;
    check_model(where, expectation.model, true);
    for (const auto& model : expectation.except) check_model(where, model);
    check_values(where, expectation.condition, true);
    if (expectation.kind == Expectation::Kind::joint) check_joint(where, expectation.model, expectation.joint);
    if (expectation.kind == Expectation::Kind::holds) check_gripper(where, expectation.gripper);
  }

  std::vector<tools::ModelParts> parts() const {
    std::vector<tools::ModelParts> all;
    for (const auto& [name, model] : models_) all.push_back(model.parts);
    return all;
  }

  void check_joint(const std::string& where, const std::string& model, const std::string& joint) {
    if (!models_.contains(model)) return;  // it is spawned, or that has been said
    if (const auto found = tools::find_joint(parts(), model, joint); !found) fail(where, found.error().message);
  }

  // Of a target MODEL::LINK.
  void check_link(const std::string& where, const std::string& target) {
    const auto colons = target.find("::");
    if (colons == std::string::npos || !models_.contains(target.substr(0, colons))) return;
    if (const auto found = tools::find_link(parts(), target.substr(0, colons), target.substr(colons + 2)); !found)
      fail(where, found.error().message);
  }

  // What is spawned may bring one.
  void check_gripper(const std::string& where, const std::string& gripper) {
    if (has_unnamed_ || !spawned_.empty()) return;
    if (const auto found = tools::find_gripper(parts(), gripper); !found) fail(where, found.error().message);
  }

  void check_event(const std::string& where, const Event& event) {
    if (event.when) check_values(where, event.when->expression);
    switch (event.kind) {
      case Event::Kind::remove:
        return check_model(where, event.target);
      case Event::Kind::push:
      case Event::Kind::wrench:
        if (is_static(event.target)) fail(where, "model " + base::in_quotes(event.target) + " is static and cannot be pushed");
        check_model(where, event.target);
        return check_link(where, event.target);
      case Event::Kind::joint_force: {
        const auto colons = event.target.find("::");
        check_model(where, event.target.substr(0, colons));
        return check_joint(where, event.target.substr(0, colons), event.target.substr(colons + 2));
      }
      case Event::Kind::pose:
        return check_model(where, event.target);
      case Event::Kind::set:
        return check_parameter(where, event);
      case Event::Kind::activate:
      case Event::Kind::deactivate:
      case Event::Kind::reset:
        return check_component(where, event.target);
      case Event::Kind::connect:
      case Event::Kind::disconnect:
        return check_connection(where, event.target);
      case Event::Kind::spawn:
        return check_new_name(where, event.name);
      case Event::Kind::command:
        return;
    }
  }

  // What the world has from its beginning, and nobody takes away, cannot be added.
  void check_new_name(const std::string& where, const std::string& name) {
    const auto takes_it = [&](const Event& event) { return event.kind == Event::Kind::remove && event.target == name; };
    if (!models_.contains(name) || std::ranges::any_of(plan_.events, takes_it) || std::ranges::any_of(plan_.hunt.events, takes_it)) return;
    fail(where, "the world has a model " + base::in_quotes(name) + " already, so none can be spawned under this name");
  }

  void check_target(const std::string& where, Fault::Object object, const std::string& name) {
    switch (object) {
      case Fault::Object::sensor:
      case Fault::Object::actuator:
        if (name.find("::") == std::string::npos)
          return fail(where, "iface " + base::in_quotes(name) + ": expected MODEL::NAME, as \"pioneer2dx::laser\"");
        return check_model(where, name);
      case Fault::Object::connector:
        return check_faulty_connection(where, name);
      case Fault::Object::component:
        return check_component(where, name);
      case Fault::Object::naming:
        return;
    }
  }

  const Plan& plan_;
  const tools::SavedSystem& system_;
  const std::map<std::string, SurveyedModel>& models_;
  std::set<std::string> spawned_;
  bool has_unnamed_ = false;  // something that is spawned has the name that its file says
  std::string problem_;
};

}  // namespace

Result<void> check_subjects(const Plan& plan, const tools::SavedSystem& system, const std::map<std::string, SurveyedModel>& models) {
  return SubjectChecks(plan, system, models).check();
}

}  // namespace campaign

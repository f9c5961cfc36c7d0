#include "campaign/run/deed_checks.h"

#include <algorithm>
#include <set>

#include "base/text.h"
#include "campaign/run/subject_checks.h"
#include "run/expectations.h"

namespace campaign {
namespace {

class DeedChecks {
 public:
  DeedChecks(const Plan& plan, const editor::SavedSystem& system, const std::map<std::string, StandingModel>& models)
      : plan_(plan), system_(system) {
    for (const auto& [name, model] : models) {
      models_.insert(name);
      standing_.insert(name);
      if (model.is_static) static_.insert(name);
    }
    for (const auto* events : {&plan.events, &plan.hunt.events}) {
      for (const auto& event : *events) {
        if (event.kind != Event::Kind::spawn) continue;
        if (event.name.empty()) has_unnamed_ = true;
        if (!event.name.empty()) models_.insert(event.name);
        static_.erase(event.name);
      }
    }
  }

  Result<void> check() {
    for (const auto& event : plan_.events) check_event("events", event);
    for (const auto& event : plan_.hunt.events) check_event("hunt: events", event);
    for (const auto& fault : plan_.faults) check_target("faults", fault.object, fault.target);
    for (const auto& target : plan_.hunt.targets) check_target("hunt: faults", target.object, target.name);
    for (const auto& condition : plan_.never) check_condition("never", condition);
    for (const auto& condition : plan_.eventually) check_condition("eventually", condition);
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

  // Of a model or a link in it, or of an iface. What is spawned without a name may have any.
  void check_model(const std::string& where, const std::string& name) {
    if (name.empty() || name == "any" || has_unnamed_ || models_.contains(name.substr(0, name.find("::")))) return;
    fail(where, "the world has no model " + base::in_quotes(name) + "; models: " + listed(models_));
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

  void check_condition(const std::string& where, const Condition& condition) {
    using Kind = recorder::Expression::Value::Kind;
    for (const auto& value : condition.expression.values()) {
      if (value.kind == Kind::state) check_component(where, value.name);
      if (value.kind == Kind::pose || value.kind == Kind::touches) check_model(where, value.name);
      if (value.kind == Kind::touches) check_model(where, value.member);
      if (value.kind != Kind::port) continue;
      check_component(where, value.name.substr(0, value.name.find(':')));
      if (const auto problem = port_problem(system_, value.name); !problem.empty()) fail(where, problem);
      if (const auto problem = value_problem(system_, value.name, value.member); !problem.empty()) fail(where, problem);
    }
  }

  void check_event(const std::string& where, const Event& event) {
    if (event.when) check_condition(where, *event.when);
    switch (event.kind) {
      case Event::Kind::remove:
        return check_model(where, event.target);
      case Event::Kind::push:
        if (!has_unnamed_ && static_.contains(event.target.substr(0, event.target.find("::"))))
          fail(where, "model " + base::in_quotes(event.target) + " is static and cannot be pushed");
        return check_model(where, event.target);
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
    if (!standing_.contains(name) || std::ranges::any_of(plan_.events, takes_it) || std::ranges::any_of(plan_.hunt.events, takes_it))
      return;
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
  const editor::SavedSystem& system_;
  std::set<std::string> models_, static_, standing_;
  bool has_unnamed_ = false;  // something that is spawned has the name that stands in its file
  std::string problem_;
};

}  // namespace

Result<void> check_deeds(const Plan& plan, const editor::SavedSystem& system, const std::map<std::string, StandingModel>& models) {
  return DeedChecks(plan, system, models).check();
}

}  // namespace campaign

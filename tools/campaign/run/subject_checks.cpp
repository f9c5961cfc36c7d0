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

using editor::Expectation;

class SubjectChecks {
 public:
  SubjectChecks(const Plan& plan, const editor::SavedSystem& system, const std::map<std::string, StandingModel>& models)
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
      const auto property = editor::parse_property(text);
      if (!property) return property.error();
      check_component("properties", property->instance);
    }
    if (!plan_.run.expectations.empty() || !plan_.expect_text.empty()) {
      const auto expectations = plan_.run.expectations.empty()
                                    ? editor::parse_expectations(plan_.expect_text, "plan " + base::in_quotes(plan_.file) + ": expect")
                                    : editor::read_expectations(plan_.run.expectations);
      if (!expectations) return expectations.error();
      for (const auto& expectation : *expectations) check_expectation(expectation);
    }
    return problem_.empty() ? Result<void>() : Error{problem_};
  }

 private:
  void fail(const std::string& where, const std::string& what) {
    if (problem_.empty()) problem_ = "plan " + base::in_quotes(plan_.file) + ": " + where + ": " + what;
  }

  void check_model(const std::string& where, const std::string& name, bool must_move = false) {
    const auto model_name = name.substr(0, name.find("::"));
    if (name.empty() || has_unnamed_ || spawned_.contains(model_name)) return;
    const auto found = models_.find(model_name);
    std::vector<std::string> names;
    for (const auto& [one, model] : models_) {
      if (!must_move || !model.is_static) names.push_back(one);
    }
    if (found != models_.end() && !(must_move && found->second.is_static)) return;
    const std::string kind = must_move ? "moving model" : "model";
    fail(where, "the world has no " + kind + " " + base::in_quotes(name) + "; " + kind +
                    "s: " + (names.empty() ? "none" : base::join(names, ", ")));
  }

  void check_component(const std::string& where, const std::string& name) {
    if (name.empty() || system_.component(name)) return;
    std::vector<std::string> names;
    for (const auto& component : system_.components) names.push_back(component.instance);
    fail(where, "the system has no component " + base::in_quotes(name) + "; components: " + base::join(names, ", "));
  }

  void check_port(const std::string& where, const std::string& port) {
    if (port.empty()) return;
    check_component(where, port.substr(0, port.find(':')));
    if (const auto problem = port_problem(system_, port); !problem.empty()) fail(where, problem);
  }

  void check_measure(const Measure& measure) {
    for (const auto& model : measure.to) check_model("measure", model);
    const bool must_move = measure.kind == Measure::Kind::path_length || measure.kind == Measure::Kind::time_to;
    check_model("measure", measure.model, must_move);
    check_port("measure", measure.port);
    if (measure.kind != Measure::Kind::value) return;
    if (const auto problem = value_problem(system_, measure.port, measure.member); !problem.empty()) fail("measure", problem);
  }

  void check_expectation(const Expectation& expectation) {
    const auto where = "expect: " + expectation.text;
    check_model(where, expectation.model, true);
    for (const auto& model : expectation.except) check_model(where, model);
    check_component(where, expectation.component);
    check_port(where, expectation.port);
    if (expectation.kind != Expectation::Kind::value) return;
    if (const auto problem = value_problem(system_, expectation.port, expectation.member); !problem.empty()) fail(where, problem);
  }

  const Plan& plan_;
  const editor::SavedSystem& system_;
  const std::map<std::string, StandingModel>& models_;
  std::set<std::string> spawned_;
  bool has_unnamed_ = false;
  std::string problem_;
};

}  // namespace

std::string port_problem(const editor::SavedSystem& system, const std::string& port) {
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

std::string value_problem(const editor::SavedSystem& system, const std::string& port, const std::string& member) {
  const auto path = editor::member_path(member);
  if (!path) return path.error().message;
  const auto is_at = [&](const editor::SavedTarget& end) {
    return end.instance + ":" + end.port_name.substr(end.port_name.find('.') + 1) == port;
  };
  bool is_read = false;
  for (const auto& connector : system.connectors) {
    if (!connector.is_data) continue;
    if (is_at(connector.source)) {
      const auto problem = editor::member_problem(connector.data_type, *path);
      return problem.empty() ? "" : "port " + base::in_quotes(port) + " sends no number " + base::in_quotes(member) + "; it has " + problem;
    }
    is_read = is_read || is_at(connector.target);
  }
  return is_read ? "port " + base::in_quotes(port) + " is no OutPort, so there are no values to see" : "";
}

Result<void> check_subjects(const Plan& plan, const editor::SavedSystem& system, const std::map<std::string, StandingModel>& models) {
  return SubjectChecks(plan, system, models).check();
}

}  // namespace campaign

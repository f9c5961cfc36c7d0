#include "campaign/run/value_script.h"

#include <map>
#include <utility>

#include "base/text.h"
#include "system/configuration.h"

namespace campaign {

ValueScript::ValueScript(const Plan& plan) {
  for (const auto& axis : plan.axes) {
    const auto words = base::split_list(axis.path, '/');
    if (words.size() != 3 || words[0] != "component" || words[2] == "rate") continue;
    for (const auto& value : axis.values) wanted_.push_back({"vary: " + axis.path, words[1], words[2], value});
  }
  for (const auto* events : {&plan.events, &plan.hunt.events}) {
    for (const auto& event : *events) {
      if (event.kind == Event::Kind::set) wanted_.push_back({"event " + event.text, event.target, event.name, event.value});
    }
  }
}

tools::Result<void> ValueScript::begin(tools::RunScene& scene) {
  std::map<std::string, tools::ComponentView> views;
  for (const auto& one : wanted_) {
    auto known = views.find(one.component);
    if (known == views.end()) {
      auto view = scene.component(one.component, {.configuration = true});
      if (!view) return view.error();
      known = views.emplace(one.component, std::move(*view)).first;
    }
    const auto problem = tools::value_problem(known->second, one.parameter, one.value);
    if (problem.empty()) continue;
    problem_ = one.where + ": cannot be " + base::in_quotes(one.value) + ", expected " + problem;
    break;
  }
  return Error{"asked"};  // no step need be made
}

}  // namespace campaign

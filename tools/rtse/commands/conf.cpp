// conf: list, get, set, use.
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "system/configuration.h"
#include "system/parameter_check.h"

namespace tools {
namespace {

struct ConfigurationOptions {
  std::string path;
  std::string action = "list";  // list, get, set, use
  std::vector<std::string> arguments;
  std::string set;     // empty: the active one
  bool all = false;    // hidden sets too
  bool force = false;  // also what the component's own types and constraints forbid
};

Error no_such_set(const ComponentView& component, const std::string& id) {
  std::vector<std::string> names;
  for (const auto& set : component.configuration_sets) {
    if (!set.is_hidden()) names.push_back(set.id);
  }
  return {"component " + component.path + ": has no configuration set " + base::in_quotes(id) + "; it has " + base::join(names, ", ")};
}

Error no_such_parameter(const ComponentView& component, const ConfigurationSetView& set, const std::string& name) {
  std::vector<std::string> names;
  for (const auto& [key, value] : set.values) names.push_back(key);
  return {"component " + component.path + ": set " + set.id + " has no parameter " + base::in_quotes(name) + "; it has " +
          base::join(names, ", ")};
}

void print_sets(Console& console, const ComponentView& component, bool all) {
  if (console.json()) {
    nlohmann::ordered_json json{{"active", component.active_set}, {"sets", nlohmann::ordered_json::object()}};
    for (const auto& set : component.configuration_sets) {
      auto values = nlohmann::ordered_json::object();
      for (const auto& [key, value] : set.values) values[key] = value;
      json["sets"][set.id] = values;
    }
    return console.print(json);
  }
  for (const auto& set : component.configuration_sets) {
    if (set.is_hidden() && !all) continue;
    std::cout << (set.id == component.active_set ? "* " : "  ") << set.id << '\n';
    for (const auto& [key, value] : set.values) std::cout << "      " << key << "  " << value << '\n';
  }
}

// What the component would not understand, or has said that it does not want.
Result<void> check_value(const ComponentView& component, const std::string& parameter, const std::string& value) {
  const auto problem = value_problem(component, parameter, value);
  if (problem.empty()) return {};
  return Error{"component " + component.path + ": parameter " + parameter + " cannot be " + base::in_quotes(value) + ", expected " +
               problem + " (--force sets it anyway)"};
}

// A parameter that was a number and gets a text, where the component declares no type: only its log says whether it takes the value.
std::string doubt(const ComponentView& component, const std::string& parameter, const std::string& before, const std::string& now) {
  if (has_type(component, parameter) || !base::parse_number(before) || base::parse_number(now)) return {};
  return "component " + component.path + ": parameter " + parameter + " was the number " + before + " and is now " + base::in_quotes(now) +
         "; the component declares no type and may keep the old value";
}

void configure(const Session& session, Console& console, const ConfigurationOptions& options) {
  auto component = session.component(options.path, {.configuration = true});
  if (!component) return console.fail(component.error());
  const auto& arguments = options.arguments;
  const CallLimit limited(session.call_timeout());
  if (!options.set.empty() && !find_set(*component, options.set)) return console.fail(no_such_set(*component, options.set));
  if (options.action == "list") {
    if (!options.set.empty()) std::erase_if(component->configuration_sets, [&](const auto& set) { return set.id != options.set; });
    return print_sets(console, *component, options.all || !options.set.empty());
  }
  if (options.action == "use" || options.action == "act") {
    if (!find_set(*component, arguments[0])) return console.fail(no_such_set(*component, arguments[0]));
    const auto used = use_set(*component, arguments[0]);
    if (!used) console.fail(used.error());
    return;
  }
  auto id = options.set.empty() ? component->active_set : options.set;
  if (id.empty()) id = "default";
  const auto* set = find_set(*component, id);
  if (!set) return console.fail(no_such_set(*component, id));
  if (set->is_hidden() && options.action == "set")
    return console.fail({"conf set: set " + id + " holds what editors know of parameters, not values"});
  if (options.action == "get") {
    for (const auto& [key, value] : set->values) {
      if (key != arguments[0]) continue;
      if (console.json()) return console.print({{key, value}});
      std::cout << value << '\n';
      return;
    }
    return console.fail(no_such_parameter(*component, *set, arguments[0]));
  }
  auto values = set->values;
  bool known = false;
  std::string doubtful;
  for (auto& [key, value] : values) {
    if (key != arguments[0]) continue;
    doubtful = doubt(*component, key, value, arguments[1]);
    value = arguments[1];
    known = true;
  }
  if (!known) return console.fail(no_such_parameter(*component, *set, arguments[0]));
  if (!options.force) {
    if (const auto good = check_value(*component, arguments[0], arguments[1]); !good) return console.fail(good.error());
  }
  if (const auto done = set_values(*component, id, values); !done) return console.fail(done.error());
  if (!doubtful.empty()) console.warn(doubtful);
  // Values reach the component when the active set is activated once more. Until then it has none, also when another set was changed.
  const auto active = component->active_set.empty() && options.set.empty() ? id : component->active_set;
  if (active.empty()) return;
  if (const auto used = use_set(*component, active); !used) console.fail(used.error());
}

}  // namespace

void add_conf(base::Command& app, Chosen& chosen) {
  auto* conf = app.add_subcommand("conf", "Show and change configuration sets: conf PATH [list | get NAME | set NAME VALUE | use SET]");
  auto options = std::make_shared<ConfigurationOptions>();
  conf->add_option("PATH", options->path, "Component")->required();
  conf->add_option("ACTION", options->action, "list, get, set or use")->check(base::one_of({"list", "get", "set", "use", "act"}));
  conf->add_option("ARGUMENT", options->arguments, "Parameter, value or set");
  conf->add_option("-s,--set", options->set, "Set to read or change (default: the active one)");
  conf->add_flag("-a,--all", options->all, "Also list hidden sets");
  conf->add_flag("--force", options->force, "Also set values that violate the component's types and constraints");
  conf->callback([&chosen, options] {
    for (auto& argument : options->arguments) {
      if (argument.starts_with(" [")) argument.erase(0, 1);  // see words_of
    }
    const auto& action = options->action;
    const auto count = options->arguments.size();
    require(action != "list" || count == 0, "conf list", "expected no further argument");
    require(action != "get" || count == 1, "conf get", "expected one parameter");
    require(action != "set" || count == 2, "conf set", "expected a parameter and a value");
    require((action != "use" && action != "act") || count == 1, "conf " + action, "expected one configuration set");
    chosen.work = [options](const Session& session, Console& console) { configure(session, console, *options); };
  });
}

}  // namespace tools

// conf: list, get, set, use.
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "rtse/commands/conf.h"
#include "system/parameter_check.h"

namespace editor {
namespace {

struct ConfigurationOptions {
  std::string path;
  std::string action = "list";  // list, get, set, use
  std::vector<std::string> arguments;
  std::string set;     // empty: the active one
  bool all = false;    // hidden sets too
  bool force = false;  // also what the component's own types and constraints forbid
};

const ConfigurationSetView* find_set(const ComponentView& component, const std::string& id) {
  for (const auto& set : component.configuration_sets) {
    if (set.id == id) return &set;
  }
  return nullptr;
}

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

void print_sets(Editor& editor, const ComponentView& component, bool all) {
  if (editor.json()) {
    nlohmann::ordered_json json{{"active", component.active_set}, {"sets", nlohmann::ordered_json::object()}};
    for (const auto& set : component.configuration_sets) {
      auto values = nlohmann::ordered_json::object();
      for (const auto& [key, value] : set.values) values[key] = value;
      json["sets"][set.id] = values;
    }
    return editor.print(json);
  }
  for (const auto& set : component.configuration_sets) {
    if (set.is_hidden() && !all) continue;
    std::cout << (set.id == component.active_set ? "* " : "  ") << set.id << '\n';
    for (const auto& [key, value] : set.values) std::cout << "      " << key << "  " << value << '\n';
  }
}

std::string hidden(const ComponentView& component, const std::string& set_id, const std::string& parameter) {
  const auto* set = find_set(component, set_id);
  if (!set) return "";
  for (const auto& [key, value] : set->values) {
    if (key == parameter) return value;
  }
  return "";
}

// What the component would not understand, or has said that it does not want.
Result<void> check_value(const ComponentView& component, const std::string& parameter, const std::string& value) {
  const auto problem = value_problem(component, parameter, value);
  if (problem.empty()) return {};
  return Error{"component " + component.path + ": parameter " + parameter + " cannot be " + base::in_quotes(value) + ", expected " +
               problem + " (--force sets it all the same)"};
}

}  // namespace

std::string value_problem(const ComponentView& component, const std::string& parameter, const std::string& value) {
  const auto problem = type_problem(hidden(component, "__type__", parameter), value);
  return problem.empty() ? constraint_problem(hidden(component, "__constraints__", parameter), value) : problem;
}

Result<void> set_values(const ComponentView& component, const std::string& id,
                        const std::vector<std::pair<std::string, std::string>>& values) {
  const auto what = "component " + component.path + ": setting configuration set " + id;
  bool accepted = false;
  auto called = remote(what + ":", [&] {
    SDOPackage::ConfigurationSet set;
    set.id = id.c_str();
    set.description = "";
    set.configuration_data.length(static_cast<CORBA::ULong>(values.size()));
    for (CORBA::ULong i = 0; i < values.size(); ++i) {
      set.configuration_data[i].name = values[i].first.c_str();
      set.configuration_data[i].value <<= values[i].second.c_str();
    }
    SDOPackage::Configuration_var configuration = configuration_of(component.object);
    accepted = configuration->set_configuration_set_values(set);
  });
  if (called && !accepted) return Error{what + ": refused"};
  return called;
}

Result<void> use_set(const ComponentView& component, const std::string& id) {
  const auto what = "component " + component.path + ": activating configuration set " + id;
  bool accepted = false;
  auto called = remote(what, [&] {
    SDOPackage::Configuration_var configuration = configuration_of(component.object);
    accepted = configuration->activate_configuration_set(id.c_str());
  });
  if (called && !accepted) return Error{what + ": refused"};
  return called;
}

namespace {

void configure(Editor& editor, const ConfigurationOptions& options) {
  auto component = editor.component(options.path, {.configuration = true});
  if (!component) return editor.fail(component.error());
  const auto& arguments = options.arguments;
  const CallLimit limited(editor.limit());
  if (!options.set.empty() && !find_set(*component, options.set)) return editor.fail(no_such_set(*component, options.set));
  if (options.action == "list") {
    if (!options.set.empty()) std::erase_if(component->configuration_sets, [&](const auto& set) { return set.id != options.set; });
    return print_sets(editor, *component, options.all || !options.set.empty());
  }
  if (options.action == "use" || options.action == "act") {
    if (!find_set(*component, arguments[0])) return editor.fail(no_such_set(*component, arguments[0]));
    const auto used = use_set(*component, arguments[0]);
    if (!used) editor.fail(used.error());
    return;
  }
  auto id = options.set.empty() ? component->active_set : options.set;
  if (id.empty()) id = "default";
  const auto* set = find_set(*component, id);
  if (!set) return editor.fail(no_such_set(*component, id));
  if (set->is_hidden() && options.action == "set")
    return editor.fail({"conf set: set " + id + " holds what editors know of parameters, not values"});
  if (options.action == "get") {
    for (const auto& [key, value] : set->values) {
      if (key != arguments[0]) continue;
      if (editor.json()) return editor.print({{key, value}});
      std::cout << value << '\n';
      return;
    }
    return editor.fail(no_such_parameter(*component, *set, arguments[0]));
  }
  auto values = set->values;
  bool known = false;
  for (auto& [key, value] : values) {
    if (key != arguments[0]) continue;
    value = arguments[1];
    known = true;
  }
  if (!known) return editor.fail(no_such_parameter(*component, *set, arguments[0]));
  if (!options.force) {
    if (const auto good = check_value(*component, arguments[0], arguments[1]); !good) return editor.fail(good.error());
  }
  if (const auto done = set_values(*component, id, values); !done) return editor.fail(done.error());
  // Values reach the component when the active set is activated once more. Until then it has none, also when another set was changed.
  const auto active = component->active_set.empty() && options.set.empty() ? id : component->active_set;
  if (active.empty()) return;
  if (const auto used = use_set(*component, active); !used) editor.fail(used.error());
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
    require(action != "list" || count == 0, "conf list", "expected nothing more");
    require(action != "get" || count == 1, "conf get", "expected one parameter");
    require(action != "set" || count == 2, "conf set", "expected a parameter and a value");
    require((action != "use" && action != "act") || count == 1, "conf " + action, "expected one configuration set");
    chosen.work = [options](Editor& e) { configure(e, *options); };
  });
}

}  // namespace editor

// save, load, start, stop, teardown: whole systems, as RTSProfile files.
#include <algorithm>
#include <ctime>
#include <iostream>
#include <map>
#include <set>

#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "rtse/commands/conf.h"
#include "rtse/commands/connect.h"
#include "rtse/commands/state.h"
#include "rtse/commands/system.h"
#include "system/profile/matched_system.h"
#include "system/tap.h"

namespace editor {
namespace {

std::string now_text() {
  const auto now = std::time(nullptr);
  std::tm parts{};
  gmtime_r(&now, &parts);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts);
  return text;
}

// "%g" would write 1000, readers of the format expect 1000.0.
std::string rate_text(double rate) {
  auto text = base::format_number(rate);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string reference_text(CORBA::ORB_ptr orb, CORBA::Object_ptr object) {
  const CORBA::String_var text = orb->object_to_string(object);
  return text.in();
}

SavedComponent to_saved(CORBA::ORB_ptr orb, const ComponentView& component) {
  SavedComponent saved;
  saved.id = component.profile_id();
  saved.path_uri = path_uri(component);
  saved.active_set = component.active_set;
  saved.instance = component.instance;
  if (component.category.starts_with("composite.")) saved.composite_type = component.category.substr(std::string("composite.").size());
  for (const auto& port : component.ports) (port.is_data_port() ? saved.data_ports : saved.service_ports).push_back({port.name});
  for (const auto& set : component.configuration_sets) {
    if (!set.is_hidden()) saved.configuration_sets.push_back({set.id, set.values});
  }
  for (const auto& context : component.contexts) {
    if (!context.is_owned) continue;
    saved.contexts.push_back({std::to_string(context.handle), kind_text(context.kind), rate_text(context.rate), state_text(context.state)});
  }
  saved.participants = component.members;
  saved.properties.emplace_back("IOR", reference_text(orb, component.object));  // the format wants it; nothing of ours reads it
  return saved;
}

SavedTarget target_of(const PortOwner& owner) {
  return {owner.component->profile_id(), owner.component->instance, owner.component->instance + "." + owner.port->name,
          path_uri(*owner.component)};
}

SavedConnector to_saved(const ConnectorView& connector, const PortOwner& source, const PortOwner& target) {
  SavedConnector saved;
  saved.is_data = source.port->is_data_port();
  saved.id = connector.id;
  saved.name = connector.name;
  saved.source = target_of(source);
  saved.target = target_of(target);
  saved.data_type = property(connector.properties, "dataport.data_type", source.port->data_type());
  saved.interface_type = property(connector.properties, "dataport.interface_type");
  saved.dataflow_type = property(connector.properties, "dataport.dataflow_type");
  saved.subscription_type = property(connector.properties, "dataport.subscription_type", "flush");
  for (const auto& [key, value] : connector.properties) {
    if (!is_reference(key, value)) saved.properties.emplace_back(key, value);
  }
  return saved;
}

// Every connection once, the OutPort or the provider's side first.
void collect_connectors(Editor& editor, const std::vector<ComponentView>& components, SavedSystem& system) {
  const CallLimit limited(editor.limit());
  std::set<std::string> seen;
  for (const auto& component : components) {
    for (const auto& port : component.ports) {
      for (const auto& connector : port.connectors) {
        if (!seen.insert(connector.id).second) continue;
        std::vector<PortOwner> owners;
        std::string absent;
        for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
          const auto owner = owner_of(connector.ports[i], components);
          if (owner.port) owners.push_back(owner);
          if (!owner.port && absent.empty()) absent = absent_port(connector.ports[i]);
        }
        if (!absent.empty() && is_tap(connector)) continue;  // somebody looks on
        if (!absent.empty() || owners.size() < 2) {
          editor.fail({"connection " + connector.id + " of port " + port.full_name + ": leads to " +
                       (absent.empty() ? "no other port" : absent) + "; it is left out"});
          continue;
        }
        if (owners.size() > 2) {
          editor.fail({"connection " + connector.id + " of port " + port.full_name + ": joins " + std::to_string(owners.size()) +
                       " ports, the file format holds two; it is left out"});
          continue;
        }
        if (owners[0].port->port_type() == "DataInPort") std::swap(owners[0], owners[1]);
        system.connectors.push_back(to_saved(connector, owners[0], owners[1]));
      }
    }
  }
}

// Does the work on all items in parallel and reports failures in order.
template <class T, class F>
void for_all(Editor& editor, const std::vector<T>& items, F work) {
  std::vector<Result<void>> results(items.size());
  in_parallel(
      items.size(), editor.limit(), [&](std::size_t i) { results[i] = work(items[i]); }, 8);
  for (const auto& result : results) {
    if (!result) editor.fail(result.error());
  }
}

// A connection that a dead process has left behind at the port that lives; one whose other ports live, or hang, is somebody's.
bool is_leftover(const ConnectorView& connector, const PortView& port) {
  for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
    try {
      if (connector.ports[i]->_is_equivalent(port.object)) continue;
      if (connector.ports[i]->_non_existent()) return true;
    } catch (const CORBA::Exception& e) {
      if (!is_time_out(e)) return true;
    }
  }
  return false;
}

Result<void> clear_leftovers(const PortView& port, const std::string& id) {
  for (const auto& connector : port.connectors) {
    if (connector.id != id || !is_leftover(connector, port)) continue;
    if (const auto done = disconnect_connector(port, id); !done) return done;
  }
  return {};
}

Result<void> restore_connection(const Matched& matched, const SavedConnector& saved, bool dry_run) {
  const auto* source = matched.port(saved.source);
  const auto* target = matched.port(saved.target);
  if (!source || !target) {
    const auto& side = source ? saved.target : saved.source;
    return Error{"connection " + saved.id + ": there is no port " + side.port_name};
  }
  for (const auto& connector : source->connectors) {
    if (connector.id == saved.id && same_connection(connector, *source, *target)) return {};  // it stands
  }
  if (dry_run) {
    std::cout << "connect " + source->full_name + " to " + target->full_name + "\n";
    return {};
  }
  for (const auto* port : {source, target}) {
    if (const auto done = clear_leftovers(*port, saved.id); !done) return done;
  }
  return connect_ports({source, target}, saved.id, saved.name, connect_properties(saved));
}

// The values that the component can take; what it has said that it cannot is added to `problems`.
std::vector<std::pair<std::string, std::string>> good_values(const ComponentView& component, const SavedConfigurationSet& set,
                                                             std::vector<std::string>& problems) {
  std::vector<std::pair<std::string, std::string>> good;
  for (const auto& [key, value] : set.values) {
    const auto problem = value_problem(component, key, value);
    if (problem.empty()) {
      good.emplace_back(key, value);
    } else {
      problems.push_back("parameter " + set.id + "." + key + " cannot be " + base::in_quotes(value) + ", expected " + problem);
    }
  }
  return good;
}

// A key that no set of the component has is set all the same, as other tools do, but most likely it is misspelt.
void tell_unknown_keys(const ComponentView& component, const SavedComponent& saved) {
  std::set<std::string> known;
  for (const auto& set : component.configuration_sets) {
    for (const auto& [key, value] : set.values) known.insert(key);
  }
  std::map<std::string, std::vector<std::string>> unknown;  // key -> sets of the profile
  for (const auto& set : saved.configuration_sets) {
    for (const auto& [key, value] : set.values) {
      if (!set.is_hidden() && !known.contains(key)) unknown[key].push_back(set.id);
    }
  }
  const auto names = known.empty() ? "none" : base::join(std::vector<std::string>(known.begin(), known.end()), ", ");
  for (const auto& [key, sets] : unknown) {
    std::cerr << "rtse: component " + component.path + " has no parameter " + key + " (in set " + base::join(sets, ", ") +
                     " of the profile); parameters: " + names + "\n";
  }
}

// Values that do not fit are left out and reported; the others are set.
Result<void> restore_configuration(const Matched& matched, const SavedComponent& saved, const LoadOptions& options) {
  const auto* component = matched.find(saved.path_uri, saved.instance);
  if (!component || !component->problem.empty()) return {};  // reported already, or optional
  tell_unknown_keys(*component, saved);
  std::vector<std::string> problems;
  for (const auto& set : saved.configuration_sets) {
    if (set.is_hidden()) continue;
    const auto values = options.force ? set.values : good_values(*component, set, problems);
    if (values.empty()) continue;
    if (options.dry_run) {
      std::cout << "set configuration " + set.id + " of " + component->path + "\n";
      continue;
    }
    if (const auto done = set_values(*component, set.id, values); !done) return done;
  }
  const auto active = saved.active_set.empty() ? component->active_set : saved.active_set;
  // A set without parameters, of a component that knows no sets: there is nothing to choose.
  const auto has_values = [&](const auto& set) { return set.id == active && !set.values.empty(); };
  const bool is_nothing = component->configuration_sets.empty() && std::ranges::none_of(saved.configuration_sets, has_values);
  if (!active.empty() && !is_nothing && !options.dry_run) {
    if (const auto used = use_set(*component, active); !used) return used;
  }
  if (problems.empty()) return {};
  return Error{"component " + component->path + ": " + base::join(problems, "; ") + " (--force sets it all the same)"};
}

int context_index(const ComponentView& component, const std::string& context_id) {
  const auto handle = base::parse_integer(context_id).value_or(0);
  for (std::size_t i = 0; i < component.contexts.size(); ++i) {
    if (component.contexts[i].handle == handle) return static_cast<int>(i);
  }
  return 0;
}

// The transitions that lead from one state to the other. An error cannot be restored: the component would have to fail again.
std::vector<Transition> way(const std::string& from, const std::string& to) {
  std::vector<Transition> steps;
  const bool is_in_error = base::equal_ignoring_case(from, "Error");
  if (is_in_error) steps.push_back(Transition::reset);
  if (base::equal_ignoring_case(to, "Active")) steps.push_back(Transition::activate);
  if (base::equal_ignoring_case(to, "Inactive") && !is_in_error) steps.push_back(Transition::deactivate);
  return steps;
}

Result<void> restore_states(const Matched& matched, const SavedComponent& saved, bool dry_run) {
  const auto* component = matched.find(saved.path_uri, saved.instance);
  if (!component || !component->problem.empty()) return {};
  for (const auto& context : saved.contexts) {
    const auto index = context_index(*component, context.id);
    if (component->contexts.empty()) return Error{"component " + component->path + ": takes part in no execution context"};
    const auto now = state_text(component->contexts[static_cast<std::size_t>(index)].state);
    if (context.state.empty() || base::equal_ignoring_case(now, context.state)) continue;
    const auto steps = way(now, context.state);
    if (steps.empty()) return Error{"component " + component->path + ": state " + context.state + " cannot be restored, it is " + now};
    if (dry_run) {
      std::cout << "bring " + component->path + " from " + now + " to " + context.state + "\n";
      continue;
    }
    auto view = *component;
    for (const auto step : steps) {
      if (const auto done = change_state(view, step, index); !done) return done;
      view.contexts[static_cast<std::size_t>(index)].state = RTC::INACTIVE_STATE;  // what a second step starts from
    }
  }
  return {};
}

// The order of a StartUp or ShutDown list; components that it does not name come last, in file order.
std::vector<SavedTurn> turns(const SavedSystem& system, const std::vector<SavedTurn>& listed) {
  auto all = listed;
  std::stable_sort(all.begin(), all.end(), [](const SavedTurn& a, const SavedTurn& b) { return a.sequence < b.sequence; });
  for (auto& turn : all) {
    const auto* component = system.component(turn.instance);
    if (turn.path_uri.empty() && component) turn.path_uri = component->path_uri;
  }
  for (const auto& component : system.components) {
    const bool named =
        std::any_of(listed.begin(), listed.end(), [&](const SavedTurn& turn) { return turn.instance == component.instance; });
    if (named) continue;
    for (const auto& context : component.contexts) all.push_back({component.instance, component.path_uri, component.id, context.id, 0});
    if (component.contexts.empty()) all.push_back({component.instance, component.path_uri, component.id, "0", 0});
  }
  return all;
}

void move_all(Editor& editor, const std::string& file, bool dry_run, Transition transition) {
  const auto system = read_system(file);
  if (!system) return editor.fail(system.error());
  const auto matched = Matched::read(editor, *system, {.contexts = true});
  if (!matched) return editor.fail(matched.error());
  for (const auto& missing : matched->missing()) editor.fail(missing);
  if (!matched->missing().empty()) return;
  const auto order = turns(*system, transition == Transition::activate ? system->start_up : system->shut_down);
  const auto step = [&](const SavedTurn& turn) -> Result<void> {
    const auto* component = matched->find(turn.path_uri, turn.instance);
    if (!component || !component->problem.empty()) return {};
    if (dry_run) {
      std::cout << (transition == Transition::activate ? "activate " : "deactivate ") + component->path + " in context " + turn.context_id +
                       "\n";
      return {};
    }
    return change_state(*component, transition, context_index(*component, turn.context_id));
  };
  const bool ordered = !(transition == Transition::activate ? system->start_up : system->shut_down).empty();
  if (!ordered && !dry_run) return for_all(editor, order, step);
  for (const auto& turn : order) {
    if (const auto done = step(turn); !done) editor.fail(done.error());
  }
}

struct SaveOptions {
  std::string file = "-";
  std::string name = "RTSystem";
  std::string vendor = "Me";
  std::string version = "0";
  std::string abstract;
  bool yaml = false;
};

void save(Editor& editor, const SaveOptions& options) {
  const auto names = editor.tree();
  if (!names) return editor.fail(names.error());
  const auto components =
      read_components(*names, {.contexts = true, .connectors = true, .configuration = true, .members = true}, editor.limit());
  SavedSystem system;
  system.id = "RTSystem:" + options.vendor + ":" + options.name + ":" + options.version;
  system.abstract = options.abstract.empty() ? "RT system saved by rtse." : options.abstract;
  system.creation_date = system.update_date = now_text();
  for (const auto& component : components) {
    if (!component.problem.empty()) {
      editor.fail({"component " + component.path + " " + component.problem + "; it is left out"});
      continue;
    }
    system.components.push_back(to_saved(editor.orb(), component));
  }
  collect_connectors(editor, components, system);
  if (options.yaml && options.file == "-") {
    std::cout << to_yaml(system);
    return;
  }
  if (const auto written = write_system(system, options.file); !written) editor.fail(written.error());
}

void stop(Editor& editor, const std::string& file, bool dry_run) { move_all(editor, file, dry_run, Transition::deactivate); }

void teardown(Editor& editor, const std::string& file, bool dry_run) {
  const auto system = read_system(file);
  if (!system) return editor.fail(system.error());
  const auto matched = Matched::read(editor, *system, {.connectors = true});
  if (!matched) return editor.fail(matched.error());
  for (const auto& missing : matched->missing()) editor.fail(missing);
  for_all(editor, system->connectors, [&](const SavedConnector& saved) -> Result<void> {
    const auto* source = matched->port(saved.source);
    const auto* target = matched->port(saved.target);
    if (!source && !target) return Error{"connection " + saved.id + ": there is no port " + saved.source.port_name};
    const auto has = [&](const PortView* port) {
      return port &&
             std::any_of(port->connectors.begin(), port->connectors.end(), [&](const auto& connector) { return connector.id == saved.id; });
    };
    const auto* port = has(source) ? source : has(target) ? target : nullptr;
    if (!port) return Error{"connection " + saved.id + ": " + (source ? source : target)->full_name + " does not have it"};
    if (!dry_run) return disconnect_connector(*port, saved.id);
    std::cout << "disconnect " + saved.id + " of " + port->full_name + "\n";
    return {};
  });
}

}  // namespace

void load(Editor& editor, const LoadOptions& options) {
  const auto system = read_system(options.file);
  if (!system) return editor.fail(system.error());
  const auto matched = Matched::read(editor, *system, {.contexts = options.with_states, .connectors = true, .configuration = true});
  if (!matched) return editor.fail(matched.error());
  for (const auto& missing : matched->missing()) editor.fail(missing);
  if (!matched->missing().empty()) return;
  for_all(editor, system->connectors, [&](const SavedConnector& saved) -> Result<void> {
    const auto optional = [&](const SavedTarget& target) {
      const auto* component = system->component(target.instance);
      return component && !component->is_required && !matched->find(target.path_uri, target.instance);
    };
    if (optional(saved.source) || optional(saved.target)) return {};
    return restore_connection(*matched, saved, options.dry_run);
  });
  for_all(editor, system->components, [&](const SavedComponent& saved) { return restore_configuration(*matched, saved, options); });
  if (!options.with_states || editor.failed()) return;
  for_all(editor, system->components, [&](const SavedComponent& saved) { return restore_states(*matched, saved, options.dry_run); });
}

void start(Editor& editor, const std::string& file, bool dry_run) { move_all(editor, file, dry_run, Transition::activate); }

void add_system(base::Command& app, Chosen& chosen) {
  auto* save = app.add_subcommand("save", "Save the running system as RTSProfile (XML; YAML by the file's ending)");
  auto options = std::make_shared<SaveOptions>();
  save->add_option("FILE", options->file, "Output file (default: standard output)");
  save->add_option("-n,--name", options->name, "System name")->capture_default_str();
  save->add_option("-e,--vendor", options->vendor, "Vendor")->capture_default_str();
  save->add_option("-v,--version", options->version, "Version of the system")->capture_default_str();
  save->add_option("-a,--abstract", options->abstract, "Description");
  save->add_flag("-y,--yaml", options->yaml, "Write YAML to standard output");
  save->callback([&chosen, options] { chosen.work = [options](Editor& e) { editor::save(e, *options); }; });

  const auto add = [&](const char* name, const char* help, void (*function)(Editor&, const std::string&, bool)) {
    auto* command = app.add_subcommand(name, help);
    auto file = std::make_shared<std::string>();
    auto dry_run = std::make_shared<bool>(false);
    command->add_option("FILE", *file, "RTSProfile, XML or YAML; -: standard input")->required();
    command->add_flag("--dry-run", *dry_run, "Print the actions without executing them");
    command->callback([&chosen, file, dry_run, function] { chosen.work = [=](Editor& e) { function(e, *file, *dry_run); }; });
  };
  auto* load = app.add_subcommand("load", "Restore connections and configuration of a saved system");
  auto load_options = std::make_shared<LoadOptions>();
  load->add_option("FILE", load_options->file, "RTSProfile, XML or YAML; -: standard input")->required();
  load->add_flag("--dry-run", load_options->dry_run, "Print the actions without executing them");
  load->add_flag("--states", load_options->with_states, "Also restore component states (activate, deactivate, reset)");
  load->add_flag("--force", load_options->force, "Also set values that violate the components' types and constraints");
  load->callback([&chosen, load_options] { chosen.work = [load_options](Editor& e) { editor::load(e, *load_options); }; });
  add("start", "Activate the components of a saved system", start);
  add("stop", "Deactivate the components of a saved system", stop);
  add("teardown", "Remove the connections of a saved system", teardown);
}

}  // namespace editor

#include "system/saved_system.h"

#include <algorithm>
#include <ctime>
#include <map>
#include <set>

#include "base/text.h"
#include "corba/ports/connection_values.h"
#include "system/configuration.h"
#include "system/connections.h"
#include "system/tap.h"

namespace tools {
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
  // Each loaded connection comes back by itself unless the profile says NO: YES would only be in profiles that had not asked for it.
  const auto is_of_loading = [](const std::string& key, const std::string& value) { return key == "dataport.reconnect" && value == "YES"; };
  for (const auto& [key, value] : connector.properties) {
    if (!is_reference(key, value) && !is_of_loading(key, value)) saved.properties.emplace_back(key, value);
  }
  return saved;
}

// Every connection once, the OutPort or the provider's side first.
void collect_connectors(const Session& session, const std::vector<ComponentView>& components, Snapshot& snapshot) {
  const CallLimit limited(session.call_timeout());
  const PortIndex index(components);
  std::set<std::string> seen;
  for (const auto& component : components) {
    for (const auto& port : component.ports) {
      for (const auto& connector : port.connectors) {
        if (!seen.insert(connector.id).second) continue;
        std::vector<PortOwner> owners;
        std::string absent;
        for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
          const auto owner = index.owner_of(connector.ports[i]);
          if (owner.port) owners.push_back(owner);
          if (!owner.port && absent.empty()) absent = absent_port(connector.ports[i]);
        }
        if (!absent.empty() && is_tap(connector)) continue;  // somebody looks on
        // To a topic: the file format wants two ends.
        if (owners.size() == 1 && connector.ports.length() == 1) owners.push_back(owners[0]);
        if (!absent.empty() || owners.size() < 2) {
          snapshot.left_out.push_back({"connection " + connector.id + " of port " + port.full_name + ": leads to " +
                                       (absent.empty() ? "no other port" : absent) + "; it is left out"});
          continue;
        }
        if (owners.size() > 2) {
          snapshot.left_out.push_back({"connection " + connector.id + " of port " + port.full_name + ": joins " +
                                       std::to_string(owners.size()) + " ports, the file format holds two; it is left out"});
          continue;
        }
        if (owners[0].port->port_type() == "DataInPort") std::swap(owners[0], owners[1]);
        snapshot.system.connectors.push_back(to_saved(connector, owners[0], owners[1]));
      }
    }
  }
}

void append(Changes& all, Changes more) {
  all.actions.insert(all.actions.end(), more.actions.begin(), more.actions.end());
  all.warnings.insert(all.warnings.end(), more.warnings.begin(), more.warnings.end());
  all.errors.insert(all.errors.end(), more.errors.begin(), more.errors.end());
}

// Does the work on all items in parallel; `work` adds what it changes to its second argument. The results are in the order of the items.
template <class T, class F>
void for_all(const Session& session, const std::vector<T>& items, Changes& all, F work) {
  std::vector<Changes> results(items.size());
  in_parallel(
      items.size(), session.call_timeout(),
      [&](std::size_t i) {
        if (const auto done = work(items[i], results[i]); !done) results[i].errors.push_back(done.error());
      },
      8);
  for (auto& result : results) append(all, std::move(result));
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

Result<void> restore_connection(const Matched& matched, const SavedConnector& saved, bool dry_run, Changes& changes) {
  const auto from = matched.port(saved.source), to = matched.port(saved.target);
  if (!from || !to) return Error{"connection " + saved.id + ": " + (from ? to : from).error().message};
  const PortView *source = *from, *target = *to;
  const auto properties = restored_properties(saved);
  for (const auto& line : corba::misunderstood_values(properties)) changes.warnings.push_back("connection " + saved.id + ": " + line);
  for (const auto& connector : source->connectors) {
    if (connector.id == saved.id && same_connection(connector, *source, *target)) return {};  // it stands
  }
  changes.actions.push_back("connect " + source->full_name + (source == target ? " to a topic" : " to " + target->full_name));
  if (dry_run) return {};
  for (const auto* port : {source, target}) {
    if (const auto done = clear_leftovers(*port, saved.id); !done) return done;
  }
  std::vector<const PortView*> ports = {source};
  if (!saved.has_one_port()) ports.push_back(target);
  return connect_ports(ports, saved.id, saved.name, properties);
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
void warn_of_unknown_keys(const ComponentView& component, const SavedComponent& saved, std::vector<std::string>& warnings) {
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
    warnings.push_back("component " + component.path + " has no parameter " + key + " (in set " + base::join(sets, ", ") +
                       " of the profile); parameters: " + names);
  }
}

// Values that do not fit are left out and reported; the others are set.
Result<void> restore_configuration(const Matched& matched, const SavedComponent& saved, const LoadOptions& options, Changes& changes) {
  const auto* component = matched.find(saved.path_uri, saved.instance);
  if (!component || !component->problem.empty()) return {};  // reported already, or optional
  warn_of_unknown_keys(*component, saved, changes.warnings);
  std::vector<std::string> problems;
  for (const auto& set : saved.configuration_sets) {
    if (set.is_hidden()) continue;
    const auto values = options.force ? set.values : good_values(*component, set, problems);
    if (values.empty()) continue;
    changes.actions.push_back("set configuration " + set.id + " of " + component->path);
    if (options.dry_run) continue;
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
  return Error{"component " + component->path + ": " + base::join(problems, "; ") + " (--force sets it anyway)"};
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

Result<void> restore_states(const Session& session, const Matched& matched, const SavedComponent& saved, bool dry_run, Changes& changes) {
  const auto* component = matched.find(saved.path_uri, saved.instance);
  if (!component || !component->problem.empty()) return {};
  for (const auto& context : saved.contexts) {
    const auto index = context_index(*component, context.id);
    if (component->contexts.empty()) return Error{"component " + component->path + ": participates in no execution context"};
    const auto now = state_text(component->contexts[static_cast<std::size_t>(index)].state);
    if (context.state.empty() || base::equal_ignoring_case(now, context.state)) continue;
    const auto steps = way(now, context.state);
    if (steps.empty()) return Error{"component " + component->path + ": state " + context.state + " cannot be restored, it is " + now};
    changes.actions.push_back("bring " + component->path + " from " + now + " to " + context.state);
    if (dry_run) continue;
    auto view = *component;
    for (const auto step : steps) {
      if (const auto done = change_state(view, step, index, session.transition_timeout()); !done) return done;
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
  std::set<std::string> named;
  for (const auto& turn : listed) named.insert(turn.instance);
  for (const auto& component : system.components) {
    if (named.contains(component.instance)) continue;
    for (const auto& context : component.contexts) all.push_back({component.instance, component.path_uri, component.id, context.id, 0});
    if (component.contexts.empty()) all.push_back({component.instance, component.path_uri, component.id, "0", 0});
  }
  return all;
}

Changes move_all(const Session& session, const SavedSystem& system, bool dry_run, Transition transition) {
  const auto matched = Matched::read(session, system, {.contexts = true});
  if (!matched) return {.errors = {matched.error()}};
  return move_all(session, *matched, system, dry_run, transition);
}

}  // namespace

Result<Snapshot> save(const Session& session, const SaveOptions& options) {
  const auto names = session.tree();
  if (!names) return names.error();
  const auto components =
      read_components(*names, {.contexts = true, .connectors = true, .configuration = true, .members = true}, session.call_timeout());
  Snapshot snapshot;
  auto& system = snapshot.system;
  system.id = "RTSystem:" + options.vendor + ":" + options.name + ":" + options.version;
  system.abstract = options.abstract.empty() ? "RT system saved by rtse." : options.abstract;
  system.creation_date = system.update_date = now_text();
  for (const auto& component : components) {
    if (!component.problem.empty()) {
      snapshot.left_out.push_back({"component " + component.path + " " + component.problem + "; it is left out"});
      continue;
    }
    system.components.push_back(to_saved(session.orb(), component));
  }
  collect_connectors(session, components, snapshot);
  return snapshot;
}

Changes load(const Session& session, const Matched& matched, const SavedSystem& system, const LoadOptions& options) {
  Changes changes{.warnings = matched.absent(), .errors = matched.missing()};
  if (!changes.ok()) return changes;
  for_all(session, system.connectors, changes, [&](const SavedConnector& saved, Changes& own) -> Result<void> {
    if (matched.leaves_out(saved.source) || matched.leaves_out(saved.target)) return {};
    return restore_connection(matched, saved, options.dry_run, own);
  });
  for_all(session, system.components, changes,
          [&](const SavedComponent& saved, Changes& own) { return restore_configuration(matched, saved, options, own); });
  if (!options.with_states || !changes.ok()) return changes;
  for_all(session, system.components, changes,
          [&](const SavedComponent& saved, Changes& own) { return restore_states(session, matched, saved, options.dry_run, own); });
  return changes;
}

Changes load(const Session& session, const SavedSystem& system, const LoadOptions& options) {
  const auto matched = Matched::read(session, system, {.contexts = options.with_states, .connectors = true, .configuration = true});
  if (!matched) return {.errors = {matched.error()}};
  return load(session, *matched, system, options);
}

Changes move_all(const Session& session, const Matched& matched, const SavedSystem& system, bool dry_run, Transition transition) {
  Changes changes{.warnings = matched.absent(), .errors = matched.missing()};
  if (!changes.ok()) return changes;
  const bool starts = transition == Transition::activate;
  const auto& listed = starts ? system.start_up : system.shut_down;
  const auto order = turns(system, listed);
  const auto step = [&](const SavedTurn& turn, Changes& own) -> Result<void> {
    const auto* component = matched.find(turn.path_uri, turn.instance);
    if (!component || !component->problem.empty()) return {};
    own.actions.push_back((starts ? "activate " : "deactivate ") + component->path + " in context " + turn.context_id);
    if (dry_run) return {};
    return change_state(*component, transition, context_index(*component, turn.context_id), session.transition_timeout());
  };
  if (listed.empty()) {
    for_all(session, order, changes, step);
    return changes;
  }
  for (const auto& turn : order) {
    if (const auto done = step(turn, changes); !done) changes.errors.push_back(done.error());
  }
  return changes;
}

Changes start(const Session& session, const SavedSystem& system, bool dry_run) {
  return move_all(session, system, dry_run, Transition::activate);
}

Changes stop(const Session& session, const SavedSystem& system, bool dry_run) {
  return move_all(session, system, dry_run, Transition::deactivate);
}

Changes teardown(const Session& session, const Matched& matched, const SavedSystem& system, bool dry_run) {
  Changes changes{.warnings = matched.absent(), .errors = matched.missing()};
  for_all(session, system.connectors, changes, [&](const SavedConnector& saved, Changes& own) -> Result<void> {
    if (matched.leaves_out(saved.source) || matched.leaves_out(saved.target)) return {};
    const auto source = matched.port(saved.source), target = matched.port(saved.target);
    if (!source && !target) return Error{"connection " + saved.id + ": " + source.error().message};
    const auto has = [&](const Result<const PortView*>& port) {
      return port && std::ranges::any_of((*port)->connectors, [&](const auto& connector) { return connector.id == saved.id; });
    };
    const PortView* port = has(source) ? *source : has(target) ? *target : nullptr;
    if (!port) return Error{"connection " + saved.id + ": " + (source ? *source : *target)->full_name + " does not have it"};
    own.actions.push_back("disconnect " + saved.id + " of " + port->full_name);
    return dry_run ? Result<void>() : disconnect_connector(*port, saved.id);
  });
  return changes;
}

Changes teardown(const Session& session, const SavedSystem& system, bool dry_run) {
  const auto matched = Matched::read(session, system, {.connectors = true});
  if (!matched) return {.errors = {matched.error()}};
  return teardown(session, *matched, system, dry_run);
}

}  // namespace tools

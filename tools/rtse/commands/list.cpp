// ls, tree, cat.
#include <algorithm>
#include <cstdlib>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string_view>
#include <unordered_map>

#include "base/text.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"

namespace tools {
namespace {

struct ListOptions {
  std::string path;
  bool is_long = false;
  bool recurse = false;
};

using Json = nlohmann::ordered_json;

std::string kind_of(const Entry& entry) {
  switch (entry.kind) {
    case EntryKind::context:
      return "context";
    case EntryKind::component:
      return "component";
    case EntryKind::manager:
      return "manager";
    case EntryKind::other:
      break;
  }
  return "object";
}

std::string health_of(const Entry& entry) {
  return entry.health == Health::alive ? "alive" : entry.health == Health::hung ? "hung" : "zombie";
}

// As rtls: a directory ends with '/', a zombie starts with '*'; a hung one with '?'.
std::string display(const Entry& entry) {
  const std::string mark = entry.health == Health::alive ? "" : entry.health == Health::hung ? "?" : "*";
  return mark + entry.name() + (entry.kind == EntryKind::context ? "/" : "");
}

std::size_t connected(const ComponentView& component, const char* type) {
  return static_cast<std::size_t>(std::count_if(component.ports.begin(), component.ports.end(), [&](const PortView& port) {
    return port.port_type() == type && !port.connectors.empty();
  }));
}
std::size_t ports(const ComponentView& component, const char* type) {
  return static_cast<std::size_t>(
      std::count_if(component.ports.begin(), component.ports.end(), [&](const PortView& port) { return port.port_type() == type; }));
}

std::string port_counts(const ComponentView& component) {
  std::string text;
  for (const auto* type : {"DataInPort", "DataOutPort", "CorbaPort"}) {
    text += (text.empty() ? "" : " ") + std::to_string(ports(component, type)) + "/" + std::to_string(connected(component, type));
  }
  return text;
}

Json summary(const Entry& entry, const ComponentView* component) {
  Json value{{"name", entry.name()}, {"path", entry.path()}, {"kind", kind_of(entry)}, {"health", health_of(entry)}};
  if (!entry.problem.empty()) value["problem"] = entry.problem;
  if (component && component->problem.empty()) {
    value["state"] = state_text(component->state());
    value["type"] = component->type;
    value["ports"] = component->ports.size();
    if (const auto* context = component->shown_context()) {
      value["rate"] = context->rate;
      value["running"] = context->is_running;
    }
  } else if (component && entry.problem.empty()) {
    value["problem"] = component->problem;
  }
  return value;
}

using Views = std::unordered_map<std::string, const ComponentView*>;  // by path

Views by_path(const std::vector<ComponentView>& components) {
  Views views;
  for (const auto& component : components) views.emplace(component.path, &component);
  return views;
}

const ComponentView* view_of(const Entry& entry, const Views& views) {
  const auto found = views.find(entry.path());
  return found == views.end() ? nullptr : found->second;
}

void print_row(std::string_view state, std::string_view rate, std::string_view ports_in_use, std::string_view name) {
  std::cout << std::left << std::setw(10) << state << ' ' << std::setw(10) << rate << ' ' << std::setw(14) << ports_in_use << ' ' << name
            << '\n';
}

void print_long(const Entry& entry, const ComponentView* component) {
  std::string state = "-";
  std::string rate = "-";
  std::string counts = "-";
  if (entry.kind == EntryKind::component)
    state = entry.health == Health::hung ? "Hung" : entry.health == Health::zombie ? "Zombie" : "Unreadable";
  if (component && component->problem.empty()) {
    state = state_text(component->state());
    if (const auto* context = component->shown_context())
      rate = context->is_running ? base::format_number(context->rate) + " Hz" : "stopped";
    counts = port_counts(*component);
  }
  print_row(state, rate, counts, display(entry));
}

void list_level(Console& console, const Entry& entry, const ListOptions& options, const Views& components, Json& json) {
  std::vector<const Entry*> shown;
  if (entry.kind == EntryKind::context) {
    for (const auto& child : entry.children) shown.push_back(&child);
  } else {
    shown.push_back(&entry);
  }
  if (options.recurse && !console.json()) std::cout << entry.path() << ":\n";
  if (options.is_long && !console.json() && !shown.empty()) print_row("STATE", "RATE", "IN OUT SERVICE", "NAME");
  for (const auto* child : shown) {
    const auto* component = view_of(*child, components);
    if (console.json()) {
      json.push_back(summary(*child, component));
    } else if (options.is_long) {
      print_long(*child, component);
    } else {
      std::cout << display(*child) << '\n';
    }
  }
  if (!options.recurse) return;
  for (const auto* child : shown) {
    if (child->kind != EntryKind::context) continue;
    if (!console.json()) std::cout << '\n';
    list_level(console, *child, options, components, json);
  }
}

void print_tree(const Entry& entry, const std::string& indent, const Views& components) {
  for (const auto& child : entry.children) {
    const bool last = &child == &entry.children.back();
    std::cout << indent << (last ? "`-- " : "|-- ") << display(child);
    const auto* component = view_of(child, components);
    if (component && component->problem.empty()) std::cout << "  [" << state_text(component->state()) << "]";
    if (!child.problem.empty()) std::cout << "  (" << child.problem << ")";
    std::cout << '\n';
    const auto deeper = indent + (last ? "    " : "|   ");
    if (component) {
      for (const auto& port : component->ports) {
        const auto mark = port.port_type() == "DataInPort" ? "-> " : port.port_type() == "DataOutPort" ? "<- " : "<> ";
        std::cout << deeper << mark << port.name << (port.data_type().empty() ? "" : " " + port.data_type()) << '\n';
      }
    }
    print_tree(child, deeper, components);
  }
}

Json to_json(const PortView& port, const std::vector<ComponentView>& all) {
  Json value{{"name", port.name}, {"type", port.port_type()}, {"data_type", port.data_type()}, {"properties", port.properties}};
  for (const auto& interface : port.interfaces) {
    value["interfaces"].push_back(
        {{"instance", interface.instance}, {"type", interface.type}, {"polarity", interface.is_provided ? "provided" : "required"}});
  }
  value["connectors"] = Json::array();
  for (const auto& connector : port.connectors) {
    Json entry{{"id", connector.id}, {"name", connector.name}, {"properties", connector.properties}, {"ports", Json::array()}};
    for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
      const auto owner = owner_of(connector.ports[i], all);
      entry["ports"].push_back(owner.port ? owner.component->path + ":" + owner.port->name : absent_port(connector.ports[i]));
    }
    value["connectors"].push_back(entry);
  }
  return value;
}

Json to_json(const ComponentView& component, const std::vector<ComponentView>& all) {
  Json value{{"path", component.path},
             {"instance", component.instance},
             {"type", component.type},
             {"category", component.category},
             {"vendor", component.vendor},
             {"version", component.version},
             {"description", component.description},
             {"state", state_text(component.state())},
             {"properties", component.properties}};
  value["ports"] = Json::array();
  for (const auto& port : component.ports) value["ports"].push_back(to_json(port, all));
  value["contexts"] = Json::array();
  for (const auto& context : component.contexts) {
    value["contexts"].push_back({{"handle", context.handle},
                                 {"owned", context.is_owned},
                                 {"kind", kind_text(context.kind)},
                                 {"rate", context.rate},
                                 {"running", context.is_running},
                                 {"state", state_text(context.state)},
                                 {"properties", context.properties}});
  }
  value["active_set"] = component.active_set;
  for (const auto& set : component.configuration_sets) {
    Json values = Json::object();
    for (const auto& [key, text] : set.values) values[key] = text;
    value["configuration"][set.id] = values;
  }
  if (!component.members.empty()) value["members"] = component.members;
  return value;
}

void print_port(const PortView& port, const std::vector<ComponentView>& all, bool is_long) {
  std::cout << (port.port_type() == "DataInPort" ? "-> " : port.port_type() == "DataOutPort" ? "<- " : "<> ") << port.name;
  if (!port.data_type().empty()) std::cout << "  " << port.data_type();
  std::cout << '\n';
  for (const auto& interface : port.interfaces) {
    std::cout << "     " << (interface.is_provided ? "provides " : "requires ") << interface.type << " as " << interface.instance << '\n';
  }
  for (const auto& connector : port.connectors) {
    std::vector<std::string> others;
    for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
      if (connector.ports[i]->_is_equivalent(port.object)) continue;
      const auto owner = owner_of(connector.ports[i], all);
      others.push_back(owner.port ? owner.component->path + ":" + owner.port->name : absent_port(connector.ports[i]));
    }
    std::cout << "     connected to " << base::join(others, ", ") << "  (" << connector.name << ", id " << connector.id << ")\n";
    if (!is_long) continue;
    for (const auto& [key, value] : connector.properties) {
      if (!value.starts_with("IOR:")) std::cout << "       " << key << " = " << value << '\n';
    }
  }
  if (!is_long) return;
  for (const auto& [key, value] : port.properties) std::cout << "     " << key << " = " << value << '\n';
}

void print_component(const ComponentView& component, const std::vector<ComponentView>& all, bool is_long) {
  std::cout << component.path << "  " << state_text(component.state()) << '\n'
            << "  " << component.profile_id() << '\n'
            << "  " << component.description << '\n';
  for (const auto& context : component.contexts) {
    std::cout << "  context " << context.handle << ": " << kind_text(context.kind) << ", " << base::format_number(context.rate) << " Hz, "
              << (context.is_running ? "running" : "stopped") << (context.is_owned ? "" : ", of another component") << ", component is "
              << state_text(context.state) << '\n';
    if (!is_long) continue;
    for (const auto& [key, value] : context.properties) std::cout << "     " << key << " = " << value << '\n';
  }
  for (const auto& set : component.configuration_sets) {
    if (set.is_hidden() && !is_long) continue;
    std::cout << "  configuration " << set.id << (set.id == component.active_set ? " (active)" : "") << '\n';
    for (const auto& [key, value] : set.values) std::cout << "     " << key << " = " << value << '\n';
  }
  if (!component.members.empty()) std::cout << "  members: " << base::join(component.members, ", ") << '\n';
  for (const auto& port : component.ports) {
    std::cout << "  ";
    print_port(port, all, is_long);
  }
  if (!is_long) return;
  std::cout << "  properties\n";
  for (const auto& [key, value] : component.properties) std::cout << "     " << key << " = " << value << '\n';
}

void cat_manager(const Session& session, Console& console, const Entry& entry) {
  const CallLimit limited(session.call_timeout());
  Properties properties;
  std::vector<std::string> components;
  const auto read = remote("manager " + entry.path(), [&] {
    const auto manager = RTM::Manager::_narrow(entry.object);
    if (CORBA::is_nil(manager)) return;
    RTM::ManagerProfile_var profile = manager->get_profile();
    properties = to_properties(profile->properties);
    RTC::ComponentProfileList_var profiles = manager->get_component_profiles();
    for (CORBA::ULong i = 0; i < profiles->length(); ++i) components.emplace_back(profiles[i].instance_name.in());
  });
  if (!read) return console.fail(read.error());
  if (console.json()) return console.print({{"path", entry.path()}, {"properties", properties}, {"components", components}});
  std::cout << entry.path() << "\n  components: " << base::join(components, ", ") << '\n';
  for (const auto& [key, value] : properties) std::cout << "  " << key << " = " << value << '\n';
}

void list(const Session& session, Console& console, const ListOptions& options) {
  const auto address = parse_address(options.path, working_path());
  if (!address) return console.fail(address.error());
  const auto names = session.tree(options.path);
  if (!names) return console.fail(names.error());
  const auto entry = names->find(*address);
  if (!entry) return console.fail(entry.error());
  std::vector<ComponentView> components;
  if (options.is_long) components = read_components(*names, {.contexts = true, .connectors = true}, session.call_timeout());
  Json json = Json::array();
  list_level(console, **entry, options, by_path(components), json);
  if (console.json()) console.print(json);
}

void tree(const Session& session, Console& console, const std::string& path) {
  const auto address = parse_address(path, working_path());
  if (!address) return console.fail(address.error());
  const auto names = session.tree(path);
  if (!names) return console.fail(names.error());
  const auto entry = names->find(*address);
  if (!entry) return console.fail(entry.error());
  const auto components = read_components(*names, {.contexts = true}, session.call_timeout());
  if (console.json()) {
    Json json = Json::array();
    list_level(console, **entry, {.path = "", .is_long = true, .recurse = true}, by_path(components), json);
    return console.print(json);
  }
  std::cout << (*entry)->path() << '\n';
  print_tree(**entry, "", by_path(components));
}

void cat(const Session& session, Console& console, const std::string& path, bool is_long) {
  const auto address = parse_address(path, working_path());
  if (!address) return console.fail(address.error());
  const auto names = session.tree(path, true);
  if (!names) return console.fail(names.error());
  const auto entry = names->find(*address);
  if (!entry) return console.fail(entry.error());
  if ((*entry)->kind == EntryKind::manager) return cat_manager(session, console, **entry);
  const auto found = names->find_component(*address);
  if (!found) return console.fail(found.error());
  const CallLimit limited(session.call_timeout());
  const auto component = read_component(**found, {.contexts = true, .connectors = true, .configuration = true, .members = true});
  if (!component.problem.empty()) return console.fail({"component " + component.path + " " + component.problem});
  const auto peers = session.peers_of(component, path);
  if (!peers) return console.fail(peers.error());
  const auto& all = *peers;
  if (address->port.empty()) {
    if (console.json()) return console.print(to_json(component, all));
    return print_component(component, all, is_long);
  }
  const auto* port = component.port(address->port);
  if (!port) return console.fail({"component " + component.path + ": has no port " + base::in_quotes(address->port)});
  if (console.json()) return console.print(to_json(*port, all));
  print_port(*port, all, is_long);
}

}  // namespace

void add_list(base::Command& app, Chosen& chosen) {
  auto* ls = app.add_subcommand("ls", "List components, managers and contexts");
  auto list = std::make_shared<ListOptions>();
  ls->add_option("PATH", list->path, "Path to list (default: the whole name server)");
  ls->add_flag("-l,--long", list->is_long, "Also show state, rate and ports (all/connected)");
  ls->add_flag("-R,--recurse", list->recurse, "Also list nested contexts");
  ls->callback(
      [&chosen, list] { chosen.work = [list](const Session& session, Console& console) { tools::list(session, console, *list); }; });

  auto* tree = app.add_subcommand("tree", "Show the name server as a tree, with states and ports");
  auto tree_path = std::make_shared<std::string>();
  tree->add_option("PATH", *tree_path, "Path of the root (default: the whole name server)");
  tree->callback([&chosen, tree_path] {
    chosen.work = [tree_path](const Session& session, Console& console) { tools::tree(session, console, *tree_path); };
  });

  auto* cat = app.add_subcommand("cat", "Show the details of a component, port or manager");
  auto cat_path = std::make_shared<std::string>();
  auto cat_long = std::make_shared<bool>(false);
  cat->add_option("PATH", *cat_path, "COMPONENT, COMPONENT:PORT or MANAGER")->required();
  cat->add_flag("-l,--long", *cat_long, "Also show all properties");
  cat->callback([&chosen, cat_path, cat_long] {
    chosen.work = [cat_path, cat_long](const Session& session, Console& console) { tools::cat(session, console, *cat_path, *cat_long); };
  });
}

}  // namespace tools

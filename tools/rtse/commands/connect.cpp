// con, dis.
#include <algorithm>
#include <iostream>
#include <set>

#include "base/suggestion.h"
#include "base/text.h"
#include "corba/ports/connection_values.h"
#include "corba/ports/peer_watch.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "system/connections.h"

namespace tools {
namespace {

// "key=value"; keys of data ports may leave out the leading "dataport.".
Result<Properties> parse_properties(const std::vector<std::string>& texts, bool data) {
  Properties properties;
  for (const auto& text : texts) {
    const auto equals = text.find('=');
    if (equals == 0 || equals == std::string::npos) return Error{"property " + base::in_quotes(text) + ": expected KEY=VALUE"};
    auto key = std::string(base::trim(text.substr(0, equals)));
    if (data && !key.starts_with("dataport.") && !key.starts_with("port.")) key = "dataport." + key;
    properties[key] = std::string(base::trim(text.substr(equals + 1)));
  }
  return properties;
}

// Keys of data ports that nobody reads; transports of modules have keys of their own. An error for what was misspelled.
Result<void> check_keys(Console& console, const Properties& properties) {
  const auto transport = property(properties, "dataport.interface_type");
  if (!transport.empty() && !is_own_transport(transport)) return {};
  for (const auto& [key, value] : properties) {
    if (!key.starts_with("dataport.") || is_connector_key(key)) continue;
    const auto name = key.substr(std::string_view("dataport.").size());
    const auto end = name.starts_with("inport.") || name.starts_with("outport.") ? name.find('.') + 1 : 0;
    const auto meant = base::suggestion(name.substr(end), connector_keys());
    const std::string line = "property " + base::in_quotes(name) + ": ports of this runtime do not read it" + meant;
    if (!meant.empty()) return Error{line};
    console.warn(line);
  }
  return {};
}

bool are_connected(const PortView& a, const PortView& b) {
  for (const auto& connector : a.connectors) {
    for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
      if (connector.ports[i]->_is_equivalent(b.object)) return true;
    }
  }
  return false;
}

// A connection of the port alone, to a topic, has these properties already. A topic may leave out its first slash. Without properties no
// topic is meant.
bool is_on_topic(const PortView& port, const Properties& properties) {
  const auto plain = [](const std::string& key, const std::string& value) {
    return key.ends_with(".topic") && value.starts_with('/') ? value.substr(1) : value;
  };
  return !properties.empty() && std::ranges::any_of(port.connectors, [&](const auto& connector) {
    return connector.ports.length() == 1 && std::ranges::all_of(properties, [&](const auto& one) {
             return plain(one.first, property(connector.properties, one.first)) == plain(one.first, one.second);
           });
  });
}

struct ConnectOptions {
  std::vector<std::string> ports;
  std::string id;
  std::string name;
  std::vector<std::string> properties;  // key=value
  bool no_duplicates = false;
};

void connect(const Session& session, Console& console, const ConnectOptions& options) {
  std::vector<Session::Port> found;
  for (const auto& path : options.ports) {
    auto port = session.port(path, options.no_duplicates);
    if (!port) return console.fail(port.error());
    found.push_back(std::move(*port));
  }
  std::vector<const PortView*> ports;
  for (const auto& port : found) ports.push_back(&port.port);
  if (options.no_duplicates && ports.size() > 1 && are_connected(*ports[0], *ports[1])) return;
  auto properties = parse_properties(options.properties, ports.front()->is_data_port());
  if (!properties) return console.reject(properties.error());
  if (const auto wrong = corba::misunderstood_values(*properties); !wrong.empty())
    return console.reject({"connecting " + base::join(options.ports, " and ") + ": " + base::join(wrong, "; ")});
  if (const auto known = ports.front()->is_data_port() ? check_keys(console, *properties) : Result<void>(); !known)
    return console.reject(known.error());
  if (options.no_duplicates && ports.size() == 1 && is_on_topic(*ports[0], *properties)) return;
  if (const auto done = connect_ports(ports, options.id, options.name, *properties); !done) console.fail(done.error());
}

void disconnect_by_id(const Session& session, Console& console, const std::string& id) {
  const auto names = session.tree();
  if (!names) return console.fail(names.error());
  const auto components = read_components(*names, {.connectors = true}, session.call_timeout());
  for (const auto& component : components) {
    for (const auto& port : component.ports) {
      const bool has =
          std::any_of(port.connectors.begin(), port.connectors.end(), [&](const auto& connector) { return connector.id == id; });
      if (!has) continue;
      if (const auto done = disconnect_connector(port, id); !done) console.fail(done.error());
      return;
    }
  }
  console.fail({"connector " + base::in_quotes(id) + ": no port has it"});
}

// Where the process of a component listens, that does not answer itself; empty: nobody knows.
std::string address_of(const Session& session, const std::string& path) {
  const auto address = parse_address(path, working_path());
  if (!address) return "";
  const auto names = session.tree(path);
  if (!names) return "";
  const auto entry = names->find(*address);
  std::string found;
  if (entry && !CORBA::is_nil((*entry)->object)) {
    const auto read = remote(path, [&] { found = corba::process_address((*entry)->object); });
    if (!read) return "";
  }
  return found;
}

// One end hangs with its process: the other knows the connection too. Which of its connections is meant is told by the process.
void disconnect_at_one_end(const Session& session, Console& console, const PortView& port, const std::string& silent_path,
                           const Error& silence) {
  const auto address = address_of(session, silent_path);
  std::vector<std::string> ids;
  for (const auto& connector : port.connectors) {
    for (CORBA::ULong i = 0; i < connector.ports.length() && !address.empty(); ++i) {
      if (connector.ports[i]->_is_equivalent(port.object) || corba::process_address(connector.ports[i]) != address) continue;
      ids.push_back(connector.id);
      break;
    }
  }
  if (ids.empty()) return console.fail(silence);
  if (ids.size() > 1) {
    return console.fail({silence.message + "; " + std::to_string(ids.size()) + " connections of " + port.full_name +
                         " lead to its process, name one: rtse dis -i " + base::join(ids, ", ")});
  }
  if (const auto done = disconnect_connector(port, ids.front()); !done) console.fail(done.error());
}

void disconnect_pair(const Session& session, Console& console, const std::string& from, const std::string& to) {
  const auto a = session.port(from, true);
  const auto b = session.port(to, true);
  if (!a && !b) return console.fail(a.error());
  if (!a) return disconnect_at_one_end(session, console, b->port, from, a.error());
  if (!b) return disconnect_at_one_end(session, console, a->port, to, b.error());
  bool any = false;
  for (const auto& connector : a->port.connectors) {
    for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
      if (!connector.ports[i]->_is_equivalent(b->port.object)) continue;
      any = true;
      if (const auto done = disconnect_connector(a->port, connector.id); !done) console.fail(done.error());
      break;
    }
  }
  if (!any) console.fail({"ports " + a->port.full_name + " and " + b->port.full_name + ": are not connected"});
}

void disconnect_all(const Session& session, Console& console, const std::string& path) {
  std::vector<PortView> ports;
  if (path.rfind(':') != std::string::npos && path.rfind(':') > path.rfind('/') + 1) {
    auto port = session.port(path, true);
    if (!port) return console.fail(port.error());
    ports.push_back(port->port);
  } else {
    auto component = session.component(path, {.connectors = true});
    if (!component) return console.fail(component.error());
    ports = component->ports;
  }
  std::set<std::string> ids;  // both ends may be among the ports
  for (const auto& port : ports) {
    for (const auto& connector : port.connectors) {
      if (!ids.insert(connector.id).second) continue;
      if (const auto done = disconnect_connector(port, connector.id); !done) console.fail(done.error());
    }
  }
}

void disconnect(const Session& session, Console& console, const std::vector<std::string>& paths, const std::string& id) {
  if (!id.empty()) return disconnect_by_id(session, console, id);
  if (paths.size() == 2) return disconnect_pair(session, console, paths[0], paths[1]);
  if (paths.size() == 1) return disconnect_all(session, console, paths[0]);
}

}  // namespace

void add_connect(base::Command& app, Chosen& chosen) {
  auto* con = app.add_subcommand("con", "Connect ports");
  auto options = std::make_shared<ConnectOptions>();
  con->add_option("PORT", options->ports, "COMPONENT:PORT, two or more; one with a transport of topics (interface_type=ros2)")
      ->required()
      ->expected(1, 64);
  con->add_option("-i,--id", options->id, "Connector ID (default: a new one)");
  con->add_option("-n,--name", options->name, "Name of the connection");
  con->add_option("-p,--property", options->properties, "KEY=VALUE, e.g. subscription_type=new")->allow_extra_args(false);
  con->add_flag("-d,--no-duplicates", options->no_duplicates,
                "Do nothing if the ports are already connected; of one port: if it has a connection with these properties");
  con->callback(
      [&chosen, options] { chosen.work = [options](const Session& session, Console& console) { connect(session, console, *options); }; });

  auto* dis = app.add_subcommand("dis", "Disconnect two ports, all connections of a port or component, or one by its ID");
  auto paths = std::make_shared<std::vector<std::string>>();
  auto id = std::make_shared<std::string>();
  dis->add_option("PATH", *paths, "Ports or a component")->expected(0, 2);
  dis->add_option("-i,--id", *id, "Connector ID");
  dis->callback([&chosen, paths, id] {
    require(!paths->empty() || !id->empty(), "dis", "expected one component or port, two ports, or -i ID");
    chosen.work = [=](const Session& session, Console& console) { disconnect(session, console, *paths, *id); };
  });
}

}  // namespace tools

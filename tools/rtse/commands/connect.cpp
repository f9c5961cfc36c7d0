// con, dis.
#include <algorithm>
#include <iostream>
#include <set>

#include "base/text.h"
#include "corba/ports/peer_watch.h"
#include "rtse/command.h"
#include "rtse/commands/commands.h"
#include "rtse/commands/connect.h"

namespace editor {
namespace {

constexpr std::chrono::seconds connect_limit{10};

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

bool offers(const PortView& port, const std::string& key, const std::string& value) {
  const auto offered = base::split_list(property(port.properties, key));
  if (offered.empty()) return true;
  return std::any_of(offered.begin(), offered.end(), [&](const std::string& one) {
    return base::equal_ignoring_case(one, "any") || base::equal_ignoring_case(one, value);
  });
}

// An end with an encoding of its own may turn one type into another.
bool is_converted(const Properties& properties) {
  for (const auto* key : {"dataport.marshaling_type", "dataport.inport.marshaling_type", "dataport.outport.marshaling_type"}) {
    const auto type = property(properties, key);
    if (!type.empty() && type != "cdr") return true;
  }
  return false;
}

Result<void> check_data_ports(const std::vector<const PortView*>& ports, const Properties& properties) {
  const auto count = [&](const char* type) {
    return std::count_if(ports.begin(), ports.end(), [&](const auto* port) { return port->port_type() == type; });
  };
  if (count("DataInPort") == 0 || count("DataOutPort") == 0) {
    return Error{"ports " + ports[0]->full_name + " and " + ports[1]->full_name + ": are both " + ports[0]->port_type() +
                 ", expected an OutPort and an InPort"};
  }
  for (const auto* port : ports) {
    const bool are_known = !port->data_type().empty() && !ports[0]->data_type().empty();
    if (are_known && port->data_type() != ports[0]->data_type() && !is_converted(properties)) {
      return Error{"ports " + ports[0]->full_name + " and " + port->full_name + ": carry different types, " + ports[0]->data_type() +
                   " and " + port->data_type()};
    }
    for (const auto* key : {"dataport.interface_type", "dataport.dataflow_type", "dataport.subscription_type"}) {
      const auto wanted = property(properties, key);
      if (!wanted.empty() && !offers(*port, key, wanted)) {
        return Error{"port " + port->full_name + ": does not offer " + key + " " + base::in_quotes(wanted) + ", it offers " +
                     property(port->properties, key)};
      }
    }
  }
  return {};
}

Result<void> check_ports(const std::vector<const PortView*>& ports, const Properties& properties) {
  const bool data = ports.front()->is_data_port();
  for (const auto* port : ports) {
    if (port->is_data_port() != data) {
      return Error{"ports " + ports.front()->full_name + " (" + ports.front()->port_type() + ") and " + port->full_name + " (" +
                   port->port_type() + "): cannot be connected"};
    }
  }
  return data ? check_data_ports(ports, properties) : Result<void>{};
}

Properties with_defaults(const PortView& port, Properties properties) {
  if (!port.is_data_port()) {
    properties.emplace("port.port_type", "CorbaPort");
    return properties;
  }
  properties.emplace("dataport.interface_type", "corba_cdr");
  properties.emplace("dataport.dataflow_type", "push");
  properties.emplace("dataport.subscription_type", "flush");
  if (!port.data_type().empty()) properties.emplace("dataport.data_type", port.data_type());
  return properties;
}

std::string names_of(const std::vector<const PortView*>& ports, const std::string& separator) {
  std::vector<std::string> names;
  for (const auto* port : ports) names.push_back(port->full_name);
  return base::join(names, separator);
}

bool are_connected(const PortView& a, const PortView& b) {
  for (const auto& connector : a.connectors) {
    for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
      if (connector.ports[i]->_is_equivalent(b.object)) return true;
    }
  }
  return false;
}

bool is_in_use(const std::vector<const PortView*>& ports, const std::string& id) {
  bool found = false;
  for (const auto* port : ports) {
    const auto asked = remote("port", [&] {
      RTC::ConnectorProfileList_var list = port->object->get_connector_profiles();
      for (CORBA::ULong i = 0; i < list->length(); ++i) found = found || (!id.empty() && id == list[i].connector_id.in());
    });
    if (!asked) continue;  // the other port knows it too
  }
  return found;
}

}  // namespace

Result<void> connect_ports(const std::vector<const PortView*>& ports, const std::string& id, const std::string& name,
                           const Properties& given) {
  const auto properties = with_defaults(*ports.front(), given);
  if (const auto fit = check_ports(ports, properties); !fit) return fit;
  for (std::size_t i = 1; i < ports.size(); ++i) {
    if (ports[i]->object->_is_equivalent(ports[0]->object)) return Error{"port " + ports[0]->full_name + ": cannot be connected to itself"};
  }
  RTC::ConnectorProfile profile;
  profile.name = name.empty() ? names_of(ports, "_").c_str() : name.c_str();
  profile.connector_id = id.c_str();
  profile.ports.length(static_cast<CORBA::ULong>(ports.size()));
  for (CORBA::ULong i = 0; i < ports.size(); ++i) profile.ports[i] = RTC::PortService::_duplicate(ports[i]->object);
  profile.properties = to_nv_list(properties);
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  const auto what = "connecting " + names_of(ports, " and ");
  const CallLimit limited(connect_limit);
  const auto called = remote(what + ": a port", [&] { code = ports.front()->object->connect(profile); });
  if (!called) return called;
  std::string meaning;
  if (code == RTC::PRECONDITION_NOT_MET)
    meaning = is_in_use(ports, id) ? "connector id " + base::in_quotes(id) + " is in use" : "they are connected already";
  if (code == RTC::BAD_PARAMETER) meaning = "a property has a value that a port does not take";
  if (code == RTC::RTC_ERROR) meaning = "a port refused, its component's log says why";
  return check(what, code, meaning);
}

Result<void> disconnect_connector(const PortView& port, const std::string& id) {
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  const auto what = "port " + port.full_name + ": disconnecting " + id;
  const CallLimit limited(connect_limit);
  const auto called = remote(what + ": the port", [&] { code = port.object->disconnect(id.c_str()); });
  if (!called) return called;
  return check(what, code);
}

namespace {

struct ConnectOptions {
  std::vector<std::string> ports;
  std::string id;
  std::string name;
  std::vector<std::string> properties;  // key=value
  bool no_duplicates = false;
};

void connect(Editor& editor, const ConnectOptions& options) {
  std::vector<Editor::Port> found;
  for (const auto& path : options.ports) {
    auto port = editor.port(path, options.no_duplicates);
    if (!port) return editor.fail(port.error());
    found.push_back(std::move(*port));
  }
  std::vector<const PortView*> ports;
  for (const auto& port : found) ports.push_back(&port.port);
  if (options.no_duplicates && are_connected(*ports[0], *ports[1])) return;
  auto properties = parse_properties(options.properties, ports.front()->is_data_port());
  if (!properties) return editor.fail(properties.error());
  if (const auto done = connect_ports(ports, options.id, options.name, *properties); !done) editor.fail(done.error());
}

void disconnect_by_id(Editor& editor, const std::string& id) {
  const auto names = editor.tree();
  if (!names) return editor.fail(names.error());
  const auto components = read_components(*names, {.connectors = true}, editor.limit());
  for (const auto& component : components) {
    for (const auto& port : component.ports) {
      const bool has =
          std::any_of(port.connectors.begin(), port.connectors.end(), [&](const auto& connector) { return connector.id == id; });
      if (!has) continue;
      if (const auto done = disconnect_connector(port, id); !done) editor.fail(done.error());
      return;
    }
  }
  editor.fail({"connector " + base::in_quotes(id) + ": no port has it"});
}

// Where the process of a component listens, that does not answer itself; empty: nobody knows.
std::string address_of(const Editor& editor, const std::string& path) {
  const auto address = parse_address(path, working_path());
  if (!address) return "";
  const auto names = editor.tree(path);
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
void disconnect_at_one_end(Editor& editor, const PortView& port, const std::string& silent_path, const Error& silence) {
  const auto address = address_of(editor, silent_path);
  std::vector<std::string> ids;
  for (const auto& connector : port.connectors) {
    for (CORBA::ULong i = 0; i < connector.ports.length() && !address.empty(); ++i) {
      if (connector.ports[i]->_is_equivalent(port.object) || corba::process_address(connector.ports[i]) != address) continue;
      ids.push_back(connector.id);
      break;
    }
  }
  if (ids.empty()) return editor.fail(silence);
  if (ids.size() > 1) {
    return editor.fail({silence.message + "; " + std::to_string(ids.size()) + " connections of " + port.full_name +
                        " lead to its process, name one: rtse dis -i " + base::join(ids, ", ")});
  }
  if (const auto done = disconnect_connector(port, ids.front()); !done) editor.fail(done.error());
}

void disconnect_pair(Editor& editor, const std::string& from, const std::string& to) {
  const auto a = editor.port(from, true);
  const auto b = editor.port(to, true);
  if (!a && !b) return editor.fail(a.error());
  if (!a) return disconnect_at_one_end(editor, b->port, from, a.error());
  if (!b) return disconnect_at_one_end(editor, a->port, to, b.error());
  bool any = false;
  for (const auto& connector : a->port.connectors) {
    for (CORBA::ULong i = 0; i < connector.ports.length(); ++i) {
      if (!connector.ports[i]->_is_equivalent(b->port.object)) continue;
      any = true;
      if (const auto done = disconnect_connector(a->port, connector.id); !done) editor.fail(done.error());
      break;
    }
  }
  if (!any) editor.fail({"ports " + a->port.full_name + " and " + b->port.full_name + ": are not connected"});
}

void disconnect_all(Editor& editor, const std::string& path) {
  std::vector<PortView> ports;
  if (path.rfind(':') != std::string::npos && path.rfind(':') > path.rfind('/') + 1) {
    auto port = editor.port(path, true);
    if (!port) return editor.fail(port.error());
    ports.push_back(port->port);
  } else {
    auto component = editor.component(path, {.connectors = true});
    if (!component) return editor.fail(component.error());
    ports = component->ports;
  }
  std::set<std::string> ids;  // both ends may be among the ports
  for (const auto& port : ports) {
    for (const auto& connector : port.connectors) {
      if (!ids.insert(connector.id).second) continue;
      if (const auto done = disconnect_connector(port, connector.id); !done) editor.fail(done.error());
    }
  }
}

void disconnect(Editor& editor, const std::vector<std::string>& paths, const std::string& id) {
  if (!id.empty()) return disconnect_by_id(editor, id);
  if (paths.size() == 2) return disconnect_pair(editor, paths[0], paths[1]);
  if (paths.size() == 1) return disconnect_all(editor, paths[0]);
  editor.fail({"dis: expected one component or port, two ports, or -i ID"});
}

}  // namespace

void add_connect(base::Command& app, Chosen& chosen) {
  auto* con = app.add_subcommand("con", "Connect ports");
  auto options = std::make_shared<ConnectOptions>();
  con->add_option("PORT", options->ports, "COMPONENT:PORT, two or more")->required()->expected(2, 64);
  con->add_option("-i,--id", options->id, "Connector ID (default: a new one)");
  con->add_option("-n,--name", options->name, "Name of the connection");
  con->add_option("-p,--property", options->properties, "KEY=VALUE, e.g. subscription_type=new")->allow_extra_args(false);
  con->add_flag("-d,--no-duplicates", options->no_duplicates, "Do nothing if the ports are already connected");
  con->callback([&chosen, options] { chosen.work = [options](Editor& e) { connect(e, *options); }; });

  auto* dis = app.add_subcommand("dis", "Disconnect two ports, all connections of a port or component, or one by its ID");
  auto paths = std::make_shared<std::vector<std::string>>();
  auto id = std::make_shared<std::string>();
  dis->add_option("PATH", *paths, "Ports or a component")->expected(0, 2);
  dis->add_option("-i,--id", *id, "Connector ID");
  dis->callback([&chosen, paths, id] {
    require(!paths->empty() || !id->empty(), "dis", "expected one component or port, two ports, or -i ID");
    chosen.work = [=](Editor& e) { disconnect(e, *paths, *id); };
  });
}

}  // namespace editor

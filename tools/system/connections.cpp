#include "system/connections.h"

#include <algorithm>
#include <array>

#include "base/text.h"
#include "corba/ports/connection_values.h"

namespace tools {

namespace {

constexpr std::array<std::string_view, 27> known_keys{"allow_dup_connection",
                                                      "buffer.length",
                                                      "buffer.read.empty_policy",
                                                      "buffer.read.timeout",
                                                      "buffer.write.full_policy",
                                                      "buffer.write.timeout",
                                                      "buffer_type",
                                                      "call_timeout",
                                                      "data_type",
                                                      "dataflow_type",
                                                      "fan_out",
                                                      "fault",
                                                      "fsm_event_name",
                                                      "interface_type",
                                                      "io_mode",
                                                      "looks_on",
                                                      "marshaling_type",
                                                      "publisher.push_policy",
                                                      "publisher.push_rate",
                                                      "publisher.skip_count",
                                                      "push_rate",
                                                      "reconnect",
                                                      "serializer.cdr.endian",
                                                      "shem_default_size",
                                                      "subscription_type",
                                                      "sync_readwrite",
                                                      "timestamp_policy"};

}  // namespace

bool is_own_transport(std::string_view interface_type) {
  constexpr std::array<std::string_view, 4> ours{"corba_cdr", "data_service", "direct", "shared_memory"};
  return std::ranges::find(ours, interface_type) != ours.end();
}

std::vector<std::string> connector_keys() { return {known_keys.begin(), known_keys.end()}; }

bool is_connector_key(std::string_view key) {
  for (const std::string_view begin : {"dataport.", "inport.", "outport."}) {
    if (key.starts_with(begin)) key.remove_prefix(begin.size());
  }
  return key.starts_with("interface_option.") || key.starts_with("corba_cdr.") || std::ranges::find(known_keys, key) != known_keys.end();
}

namespace {

constexpr std::chrono::milliseconds connect_limit{10'000};

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
  const auto interface = property(properties, "dataport.interface_type");
  if (ports.size() == 1 && is_own_transport(interface))
    return Error{"port " + ports[0]->full_name + ": expected a second port, or a transport of topics as in -p interface_type=ros2"};
  if (ports.size() > 1 && (count("DataInPort") == 0 || count("DataOutPort") == 0)) {
    return Error{"ports " + ports[0]->full_name + " and " + ports[1]->full_name + ": are both " + ports[0]->port_type() +
                 ", expected an OutPort and an InPort"};
  }
  for (const auto* port : ports) {
    if (carry_different_types(*port, *ports[0]) && !is_converted(properties)) {
      return Error{"ports " + ports[0]->full_name + " and " + port->full_name + ": carry different types, " + ports[0]->data_type() +
                   " and " + port->data_type()};
    }
    for (const auto* key : {"dataport.interface_type", "dataport.dataflow_type", "dataport.subscription_type"}) {
      const auto wanted = property(properties, key);
      if (!wanted.empty() && !offers(*port, key, wanted)) {
        const bool is_of_module = wanted == "ros2" || wanted == "fast-rtps" || wanted == "cyclone-dds";
        return Error{"port " + port->full_name + ": does not offer " + key + " " + base::in_quotes(wanted) + ", it offers " +
                     property(port->properties, key) +
                     (is_of_module ? "; its component host does not find the module ROS2Transport (package rtm-ros2)" : "")};
      }
    }
  }
  return {};
}

Result<void> check_ports(const std::vector<const PortView*>& ports, const Properties& properties) {
  const bool data = ports.front()->is_data_port();
  if (ports.size() == 1 && !data) return Error{"port " + ports[0]->full_name + ": expected a second port"};
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

bool carry_different_types(const PortView& a, const PortView& b) {
  const auto fits_all = [](const std::string& type) { return type.empty() || base::equal_ignoring_case(type, "any"); };
  return !fits_all(a.data_type()) && !fits_all(b.data_type()) && a.data_type() != b.data_type();
}

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
  if (code == RTC::BAD_PARAMETER) {
    const auto reason = corba::refusal_of_values(properties);
    meaning = reason.empty() ? "a property has a value that a port does not take" : reason;
  }
  if (code == RTC::UNSUPPORTED) meaning = corba::refusal_of_values(properties);
  if (code == RTC::RTC_ERROR) meaning = "a port rejected the connection; the log of its component has the reason";
  return check(what, code, meaning);
}

Result<void> disconnect_connector(const PortView& port, const std::string& id) {
  RTC::ReturnCode_t code = RTC::RTC_ERROR;
  const auto what = "port " + port.full_name + ": disconnecting " + id;
  const CallLimit limited(connect_limit);
  const auto called = remote(what + ": the port", [&] { code = port.object->disconnect(id.c_str()); });
  if (!called) return called;
  // A port drops the connections of a peer that died by itself, also between the look at it and this call.
  const bool was_seen = std::ranges::any_of(port.connectors, [&](const auto& connector) { return connector.id == id; });
  if (code == RTC::BAD_PARAMETER && was_seen && !is_in_use({&port}, id)) return {};
  return check(what, code);
}

}  // namespace tools

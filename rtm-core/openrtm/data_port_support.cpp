#include "openrtm/data_port_support.h"

#include <algorithm>

#include "base/text.h"
#include "corba/orb/nv_list.h"
#include "corba/ports/connector_keys.h"
#include "core/log_rate_limiter.h"
#include "manager/transport_modules.h"
#include "openrtm/interface_plugins.h"
#include "rtm/CORBA_SeqUtil.h"
#include "rtm/NVUtil.h"

namespace RTC::detail {

static_assert(static_cast<int>(rt::PortStatus::unknown_error) == DataPortStatus::UNKNOWN_ERROR);
static_assert(static_cast<int>(rt::PortStatus::connection_lost) == DataPortStatus::CONNECTION_LOST);

std::string short_name(const std::string& name) {
  const auto dot = name.rfind('.');
  return dot == std::string::npos ? name : name.substr(dot + 1);
}

namespace {
constexpr const char* interfaces = "corba_cdr,data_service,direct,shared_memory";

const char* port_type(rt::Side side) { return side == rt::Side::in ? "DataInPort" : "DataOutPort"; }
}  // namespace

void show_interfaces_of_authors(PortProfile& profile, rt::Side side) {
  auto names = interfaces_of_authors(side);
  for (auto& name : transports_of_modules()) {
    if (std::ranges::find(names, name) == names.end()) names.push_back(std::move(name));
  }
  if (names.empty()) return;
  corba::set_text(profile.properties, "dataport.interface_type", std::string(interfaces) + "," + base::join(names, ","));
  for (const std::string& name : names) {
    const coil::Properties options = options_of_author_interface(name, side);
    corba::set_text(profile.properties, "dataport.interface_option." + name, "");
    for (const std::string& key : options.propertyNames()) {
      corba::set_text(profile.properties, "dataport.interface_option." + name + "." + key, options.getProperty(key));
    }
  }
}

std::vector<AdvertisedKey> advertised_keys(rt::Side side, const std::string& type_id) {
  std::vector<AdvertisedKey> keys = {{"port.port_type", port_type(side)},
                                     {"dataport.data_type", type_id},
                                     {"data_type", type_id},
                                     {"dataport.subscription_type", side == rt::Side::in ? "Any" : "block,flush,new,nonblock,periodic"},
                                     {"dataport.dataflow_type", "push,pull"},
                                     {"dataport.interface_type", interfaces}};
  if (side == rt::Side::out) keys.push_back({"dataport.io_mode", "block,flush,new,nonblock,periodic"});
  for (const char* key : {"dataport.interface_option.corba_cdr", "dataport.interface_option.data_service",
                          "dataport.interface_option.direct", "dataport.interface_option.shared_memory"}) {
    keys.push_back({key, ""});
  }
  return keys;
}

void complete_data_profile(ConnectorProfile& profile) {
  corba::remove_references(profile);
  if (!corba::find_value(profile.properties, "dataport.serializer.cdr.endian")) {
    corba::set_text(profile.properties, "dataport.serializer.cdr.endian", "little,big");
  }
}

namespace {

// A transport that is not registered may come as a module. The encoding of a connection that names none is that of its transport.
rt::ConnectorSettingsOutcome read_settings(const rt::KeyValues& values, rt::Side side) {
  const std::string own_side = side == rt::Side::in ? "dataport.inport." : "dataport.outport.";
  const auto text = [&](const std::string& key) {
    for (const auto& full : {own_side + key, "dataport." + key}) {
      if (const auto found = values.find(full); found != values.end()) return std::string(base::trim(found->second));
    }
    return std::string();
  };
  const std::string interface = text("interface_type");
  auto transports = interfaces_of_authors(side);
  std::string missing;
  if (std::ranges::find(transports, interface) == transports.end()) {
    missing = load_transport_module(interface);
    transports = interfaces_of_authors(side);
  }
  auto outcome = rt::read_connector_settings(values, side, transports);
  if (!missing.empty()) outcome.refusal.reason += ": " + missing;
  if (outcome.settings.interface == rt::Interface::foreign && text("marshaling_type").empty()) {
    const std::string usual = options_of_author_interface(interface, side).getProperty("marshaling_type");
    if (!usual.empty()) outcome.settings.marshaling = usual;
  }
  return outcome;
}

}  // namespace

rt::ConnectorSettingsOutcome settings_of(const ConnectorProfile& profile, const coil::Properties& port, rt::Side side) {
  rt::KeyValues values;
  for (const auto& name : port.propertyNames()) {
    const std::string& value = port.getProperty(name);
    if (value.empty()) continue;
    values[name.starts_with("dataport.") ? name : "dataport." + name] = value;
  }
  for (auto& [name, value] : corba::to_key_values(profile.properties)) {
    if (!value.empty()) values[name] = value;
  }
  return read_settings(values, side);
}

void share_port_properties(ConnectorProfile& profile, const coil::Properties& port) {
  for (const auto& name : port.propertyNames()) {
    const std::string& value = port.getProperty(name);
    const std::string key = name.starts_with("dataport.") ? name.substr(9) : name;
    if (value.empty() || key.starts_with("inport.")) continue;
    const std::string shown = key.starts_with("outport.") ? "dataport." + key : "dataport.outport." + key;
    const bool is_said = !corba::find_text(profile.properties, shown).value_or("").empty() ||
                         (shown != "dataport." + key && !corba::find_text(profile.properties, "dataport." + key).value_or("").empty());
    if (!is_said) corba::set_text(profile.properties, shown, value);
  }
}

bool says_when_empty(const ConnectorProfile& profile) {
  return rt::read_empty_policy(corba::to_key_values(profile.properties), rt::Side::out) != rt::EmptyPolicy::readback;
}

namespace {

// One end at least has an encoding of its own, whose octets may be those of another type.
bool converts(const ConnectorProfile& profile, const std::string& own) {
  if (own != "cdr") return true;
  for (const char* key : {"dataport.marshaling_type", "dataport.inport.marshaling_type", "dataport.outport.marshaling_type"}) {
    const std::string given = corba::find_text(profile.properties, key).value_or("");
    if (const auto type = base::trim(given); !type.empty() && type != "cdr") return true;
  }
  return false;
}

}  // namespace

void log_refused_connection(const Logger& rtclog, const std::string& why) {
  rt::log_rejection(rtclog, Logger::RTL_WARN, "connection rejected: " + why);
}

ReturnCode_t check_connection(ConnectorProfile& profile, const rt::ConnectorSettingsOutcome& outcome, rt::Side side, const Carries& own,
                              Logger& rtclog) {
  for (const auto& warning : outcome.warnings) rt::log_rejection(rtclog, Logger::RTL_WARN, warning);
  if (outcome.refusal.code != rt::ReturnCode::ok) {
    log_refused_connection(rtclog, outcome.refusal.reason);
    return static_cast<ReturnCode_t>(outcome.refusal.code);
  }
  const std::string& marshaling = outcome.settings.marshaling;
  const bool is_known = std::ranges::find(own.marshalings, marshaling) != own.marshalings.end();
  if (!is_known && outcome.settings.interface == rt::Interface::foreign &&
      marshaling == options_of_author_interface(outcome.settings.foreign_interface, side).getProperty("marshaling_type")) {
    log_refused_connection(rtclog, "interface_type " + outcome.settings.foreign_interface + " has no encoding of " + own.type_id +
                                       "; dataport.marshaling_type may name one of " + base::join(own.marshalings, ", "));
    return RTC_ERROR;
  }
  if (!is_known) {
    log_refused_connection(rtclog, "dataport.marshaling_type must be " + base::join(own.marshalings, " or ") + " for a " + own.type_id +
                                       ", got " + base::in_quotes(marshaling));
    return RTC_ERROR;
  }
  const bool is_in = side == rt::Side::in;
  if (marshaling != "cdr") {
    corba::set_text(profile.properties, is_in ? "dataport.inport.marshaling_type" : "dataport.outport.marshaling_type", marshaling);
  }
  const bool any_type_fits = converts(profile, marshaling);
  for (const char* key : {"dataport.data_type", "dataport.inport.data_type", "dataport.outport.data_type"}) {
    const auto other = corba::find_text(profile.properties, key);
    const bool is_own = std::string_view(key) == (is_in ? "dataport.inport.data_type" : "dataport.outport.data_type");
    if (!other || is_own || any_type_fits || rt::are_compatible_types(*other, own.type_id)) continue;
    log_refused_connection(rtclog, std::string(key) + " is " + base::in_quotes(*other) + ", this port has " + own.type_id);
    return BAD_PARAMETER;
  }
  corba::set_text(profile.properties, is_in ? "dataport.inport.data_type" : "dataport.outport.data_type", own.type_id);
  return RTC_OK;
}

ConnectorInfo make_info(const ConnectorProfile& profile, const coil::Properties& port, rt::Side side, const std::string& type_id) {
  ConnectorInfo info;
  info.name = profile.name.in();
  info.id = profile.connector_id.in();
  info.ports = CORBA_SeqUtil::refToVstring(profile.ports);
  info.properties["port.port_type"] = port_type(side);
  info.properties["data_type"] = type_id;
  info.properties << port;
  if (const coil::Properties* dataport = port.findNode("dataport")) info.properties << *dataport;
  const coil::Properties all = NVUtil::toProperties(profile.properties);
  if (const coil::Properties* dataport = all.findNode("dataport")) info.properties << *dataport;
  if (info.properties.getProperty("io_mode").empty()) {
    const std::string subscription = info.properties.getProperty("subscription_type");
    if (!subscription.empty())
      info.properties.setProperty("io_mode", subscription == "flush" ? "block" : subscription == "new" ? "nonblock" : subscription);
  }
  return info;
}

DataPortStatusList to_classic(const std::vector<rt::PortStatus>& statuses) {
  DataPortStatusList list;
  for (const auto status : statuses) list.push_back(to_classic(status));
  return list;
}

}  // namespace RTC::detail

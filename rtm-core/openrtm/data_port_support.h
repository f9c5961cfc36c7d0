// The common part of InPortBase and OutPortBase. Not for component authors.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "core/connector_settings.h"
#include "core/port_status.h"
#include "rtm/ConnectorBase.h"
#include "rtm/PortBase.h"

namespace RTC::detail {

// The part of a port's name after the owner's.
std::string short_name(const std::string& name);

// Writes into the profile what a data port of this type advertises.
struct AdvertisedKey {
  const char* key;
  std::string value;
};
std::vector<AdvertisedKey> advertised_keys(rt::Side side, const std::string& type_id);

// Adds what has been registered by now.
void show_interfaces_of_authors(PortProfile& profile, rt::Side side);

// Fills in what a client may leave out, and takes out what must not be trusted.
void complete_data_profile(ConnectorProfile& profile);

// The settings of the connection: the port's own properties, then `dataport.*`, then those of the side.
rt::ConnectorSettingsOutcome settings_of(const ConnectorProfile& profile, const coil::Properties& port, rt::Side side);
// The OutPort of this connection does not hand out samples twice.
bool says_when_empty(const ConnectorProfile& profile);

// Shows the peer what this OutPort's own properties say about the connection, as dataport.outport.*, where the profile says nothing.
void share_port_properties(ConnectorProfile& profile, const coil::Properties& port);

// Logs why a connection is rejected (core/log_rate_limiter.h).
void log_refused_connection(const Logger& rtclog, const std::string& why);

// RTC_OK, or the code with which to reject; says why in the log, and what is odd about the settings. Announces the type of this side in the
// profile.
struct Carries {
  std::string type_id;
  std::vector<std::string> marshalings;
};
ReturnCode_t check_connection(ConnectorProfile& profile, const rt::ConnectorSettingsOutcome& outcome, rt::Side side, const Carries& own,
                              Logger& rtclog);

// What listeners learn: the type and kind of this side, the port's own properties and `dataport.*` of the connection; later ones count
// more.
ConnectorInfo make_info(const ConnectorProfile& profile, const coil::Properties& port, rt::Side side, const std::string& type_id);

inline DataPortStatus to_classic(rt::PortStatus status) { return static_cast<DataPortStatus::Enum>(status); }
DataPortStatusList to_classic(const std::vector<rt::PortStatus>& statuses);

}  // namespace RTC::detail

// The connections that manager.components.preconnect asks for:
// `comp.port?port=comp2.port2&interface_type=...&...`, separated by commas. Any thread.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"

namespace rt {

struct PortAddress {
  std::string component;  // instance name or URL
  std::string port;       // without the instance name
  bool operator==(const PortAddress&) const = default;
};

struct ConnectionRequest {
  std::string name;  // the whole text
  PortAddress port;
  std::vector<PortAddress> others;                              // one connection to each
  std::vector<std::pair<std::string, std::string>> properties;  // without the prefix dataport.
};

// `comp.port`, `rtcname://host:port/path/comp.port`: the port begins at the first dot after the last slash.
base::Result<PortAddress> parse_port_address(std::string_view text);
// One request.
base::Result<ConnectionRequest> parse_connection(std::string_view text);

}  // namespace rt

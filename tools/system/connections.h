// Connects and disconnects ports. One thread at a time.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "system/component_view.h"

namespace tools {

// Of the runtime itself, all of which connect two ports; other interface types are of modules.
bool is_own_transport(std::string_view interface_type);

// The keys of a connection that ports of this runtime read, without "dataport."; each also as inport.KEY and outport.KEY, for one end.
std::vector<std::string> connector_keys();
// Whether ports read "dataport.KEY". What a transport of a module reads is known to the module alone.
bool is_connector_key(std::string_view key);

// Connects ports in the given order; the first starts. Empty id: the runtime makes one. The error says what does not fit.
Result<void> connect_ports(const std::vector<const PortView*>& ports, const std::string& id, const std::string& name,
                           const Properties& properties);
// Whether the types of two data ports are known and differ. "Any", as of ports of events, fits all.
bool carry_different_types(const PortView& a, const PortView& b);
// One that the port has dropped by itself since it was looked at counts as ended.
Result<void> disconnect_connector(const PortView& port, const std::string& id);

}  // namespace tools

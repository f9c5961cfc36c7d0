// Adapts transports of component authors to ports. Not for component authors. Any thread.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "corba/transport/transport.h"
#include "rtm/ConnectorBase.h"

namespace RTC::detail {

// Those for which this side has an end, in alphabetical order.
std::vector<std::string> interfaces_of_authors(rt::Side side);
// What an end of this side says about itself when it was registered.
coil::Properties options_of_author_interface(const std::string& name, rt::Side side);

// For the connection of that connector, which gets and gives the samples.
std::shared_ptr<corba::Carrier> make_author_carrier(const rt::ConnectorSettings& settings, std::shared_ptr<ConnectorBase> connector);

}  // namespace RTC::detail

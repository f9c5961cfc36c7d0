// Which messages of which interface are served: what a client hears that asks for capabilities. Values; any thread.
#pragma once

#include <cstdint>

#include "protocol/message.h"

namespace gateway {

// `type` and `subtype` as a client has sent them.
bool is_served(player::Interface interface, std::uint32_t type, std::uint32_t subtype);

}  // namespace gateway

// The messages that a device receives and sends: a table in each class, used for dispatch, for capability requests, and for docs/player.md.
// Values; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "protocol/message.h"

namespace gateway {

struct Served {
  player::Type type = player::Type::request;
  std::uint8_t subtype = 0;
  std::string_view what;  // for people; rows of one type are joined, so that an empty one adds nothing
};
using ServedTable = std::span<const Served>;

// `type` and `subtype` as a client has sent them. Requests that each interface has are not in tables.
bool is_served(ServedTable table, std::uint32_t type, std::uint32_t subtype);

// "scan with intensities": what the rows of one type say.
std::string describe(ServedTable table, player::Type type);

}  // namespace gateway

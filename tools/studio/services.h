// Requests to the simulator as services of foxglove.websocket.v1: /simulator/pause, /simulator/spawn, ... Arguments and results are those
// of the acts of the same name (docs/develop/studio-protocol.md), as JSON. Values; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "studio/acts.h"

namespace studio {

// The message advertiseServices. `may_act`: those that change the world, too.
std::string advertise_services(bool may_act);

struct Service {
  std::string name;
  const Act* act = nullptr;
};
// nullopt: no service has this number.
std::optional<Service> find_service(std::uint32_t id);

// The arguments in a call's payload: a JSON object, or nothing.
base::Result<Json> arguments_of(const ServiceCall& call);

}  // namespace studio

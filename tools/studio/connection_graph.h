// Maps each topic to the components that publish it and those that receive it, as foxglove.websocket.v1 has it. Pure; any thread.
#pragma once

#include <string>

#include "studio/client_message.h"

namespace studio {

// Of the events `system` and `signals`: {publishedTopics, subscribedTopics, advertisedServices}. Ports whose topic is not known are left
// out.
Json connection_graph(const Json& system, const Json& signals);
// The message that leads from one graph to the next; `before` may be null.
std::string graph_update(const Json& before, const Json& now);

}  // namespace studio

// Where the models stand that do not move. Asks the simulator, for at most three seconds. Any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "base/result.h"
#include "ros/messages.h"

namespace channels {

base::Result<std::vector<ros::TransformStamped>> static_models_of(std::uint32_t server_id);

}  // namespace channels

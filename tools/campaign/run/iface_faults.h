// The faults that the simulator supports for the sensors and drives of the plan's world, as reported by the simulator. One thread at a
// time.
#pragma once

#include <vector>

#include "campaign/run/campaign.h"

namespace campaign {

// Whether the faults that a plan names fit. The error is one line.
Result<void> check_iface_faults(const Plan& plan);
// What a hunt may break: of what the plan names, or else all that the system has, each with all faults that fit it.
Result<std::vector<HuntTarget>> hunt_targets(const Campaign& campaign);

}  // namespace campaign

// The true pose and velocity of a model that can move. See device.h for the thread rule.
#pragma once

#include "devices/sensors/sensor.h"

namespace sim {

MadeDevice make_truth(DeviceWorld& world, ModelId model);

}  // namespace sim

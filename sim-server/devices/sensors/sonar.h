// Sonars: one or more transducers of a model as one iface. Each measures the distance of the nearest object in its cone. See device.h for
// the thread rule.
#pragma once

#include "devices/sensors/sensor.h"

namespace sim {

struct Transducer {
  Mount mount;
  const SensorDef* sensor;
};

// `scope` is the nested model that they stand in; the first transducer's ranges, rate and noise are those of all.
MadeDevice make_sonar_ring(DeviceWorld& world, const std::string& name, const std::string& scope,
                           const std::vector<Transducer>& transducers);

}  // namespace sim

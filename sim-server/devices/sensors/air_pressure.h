// The air over the world, for the sensor of its pressure. Pure; any thread.
#pragma once

namespace sim {

// [Pa] at an altitude [m] of the standard atmosphere with the world's temperature [K] and pressure [Pa] at sea level.
double air_pressure_at(double altitude, double temperature, double pressure);

}  // namespace sim

// Converts a point of a world to latitude, longitude and altitude, for the gps. Pure; any thread.
#pragma once

#include "world/world_def.h"

namespace sim {

// Latitude, longitude [degree] and altitude [m] of a point given in east, north, up [m] around a place, on the WGS 84 ellipsoid.
Eigen::Vector3d geodetic_of(const SphericalDef& place, const Eigen::Vector3d& east_north_up);

}  // namespace sim

// Lidars of Gazebo that draw (gpu_lidar, gpu_ray) see visuals; all of ours meet collisions. Any thread.
#pragma once

#include "world/complaints.h"

namespace sim {

// One note when a world has such a lidar and models with visuals but without any collision.
void tell_of_unseen_models(const WorldDef& world, Complaints& complaints);

}  // namespace sim

// A model as URDF, for robot_description: the base and a link for each moving joint, with their shapes. The frame of a link is that of its
// joint. Pure; any thread.
#pragma once

#include <string>

#include "shm/client.h"
#include "world.h"

namespace ros2 {

// `joints`: nothing for a model without joints iface. `base`: the frame base_link, on the model.
std::string urdf_of(const ListedModel& model, const shm::Iface* joints, const shm::Pose& base);

}  // namespace ros2

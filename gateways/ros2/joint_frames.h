// The frames of a robot's moving joints, as URDF has them: the frame of a link is that of the joint that moves it. Pure; any thread.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "shm/iface_types.h"
#include "shm/layout.h"
#include "world.h"

namespace ros2 {

// What moves a link along or about its joint's axis. Position [rad, m].
shm::Pose motion_of(const shm::Joint& joint, double position);

// The frame of joint `i` on the model. `position_of`: of each joint; nothing: all are at 0.
shm::Pose joint_frame(std::span<const shm::Joint> joints, std::size_t i, const std::function<double(const shm::Joint&)>& position_of = {});

// The moving link that carries a link, by fixed joints or as itself; empty for one that does not move on the base.
std::string carrier_of(const ListedModel& model, std::string link, const std::function<bool(const std::string&)>& moves);

}  // namespace ros2

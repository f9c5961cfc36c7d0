// Boxes around the shapes of entities, and bounds as simulation_interfaces has them. Lengths in m. Values; any thread.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>

#include "ros/simulation_services.h"
#include "shm/layout.h"

namespace ros2 {

// Around all shapes that collide, along the axes of the entity's own frame, which has this pose in the world. A point without a shape.
struct EntityBox {
  shm::Pose pose = shm::identity_pose;
  std::array<double, 3> low{}, high{};
};
// By entity. From the reply to a TreeRequest with bounds.
std::map<std::string, EntityBox> boxes_in(const std::string& tree);

// In the entity's own frame; empty bounds, which mean "unbounded", when a side has no end.
ros::Bounds bounds_of(const EntityBox& box);
// Why entities cannot be filtered by these bounds; nothing when they can.
std::optional<ros::SimulationResult> problem_of(const ros::Bounds& bounds);
// Good bounds in the world and the box have a point in common.
bool overlaps(const EntityBox& box, const ros::Bounds& bounds);

}  // namespace ros2

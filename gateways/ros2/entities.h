// Entities, as simulation_interfaces calls the models of a world, and the filters of clients. Values; any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "ros/simulation_services.h"

namespace ros2 {

struct Entity {
  std::string name;
  std::uint8_t category = ros::EntityCategory::dynamic_object;
};

// From the reply to a ListRequest.
std::vector<Entity> entities_in(const std::string& list);

// Why the filter cannot be used, as a result of simulation_interfaces; nothing when it can.
std::optional<ros::SimulationResult> problem_of(const ros::EntityFilters& filters);
// Those that a good filter names; its bounds do not count.
std::vector<Entity> filtered(std::vector<Entity> entities, const ros::EntityFilters& filters);

}  // namespace ros2

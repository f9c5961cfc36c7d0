// The shapes of a simulator's models as markers that viewers draw: a marker for each visible shape, in the frame of its link, as triangles
// in one colour. Made from the simulator's export (docs/simulator.md), so that every kind of shape is there; what bends (actors) and
// pictures on surfaces are left out. Pure, but for shapes_of(), which asks the simulator, for at most a minute. Any thread.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "ros/messages.h"

namespace channels {

// [bytes] of markers; of worlds with more the largest shapes are left out.
inline constexpr std::size_t max_shapes = std::size_t{64} << 20;

// Of glTF 2.0 binary as the simulator writes it. The stamps are 0, the ids count within each model (`ns`).
base::Result<std::vector<ros::Marker>> markers_in(std::string_view glb);

// The frames of all links of the scene, in its order: those of models, then each actor and its bones.
base::Result<std::vector<std::string>> links_in(std::string_view glb);

base::Result<std::vector<ros::Marker>> shapes_of(std::uint32_t server_id);

}  // namespace channels

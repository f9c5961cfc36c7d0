// Checks what Assimp hands over: importers do not check all indexes of a file, and steps after them, as the code here, read arrays by them.
// One thread at a time.
#pragma once

#include <assimp/scene.h>

#include <Eigen/Core>

#include "base/result.h"

namespace sim {

// Indexes of vertices, meshes and bones are in range, and arrays that are counted are there. Nodes nest at most deepest_node deep. No face
// has more corners than most_invented_corners which its mesh cannot have: Assimp fills a list with zeros that counts more than its file
// holds, and makes triangles of 65536 corners in 6 s, of this many in 1 s. One line for what does not hold.
inline constexpr unsigned deepest_node = 1000;
inline constexpr unsigned most_invented_corners = 1 << 15;
base::Result<void> check_scene(const aiScene& scene);

// A triangle has a corner there: not a number, or too far away. The line of its file.
base::Error lost_corner(const Eigen::Vector3d& at);

// Faces without corners: Assimp takes them for polygons, and the step that makes triangles ends the process over them. For a scene that was
// checked, before its steps.
void drop_empty_faces(const aiScene& scene);

}  // namespace sim

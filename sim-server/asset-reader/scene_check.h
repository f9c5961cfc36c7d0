// Checks a scene of Assimp. Importers do not check all indexes of a file, but later steps, and the code here, use them as array indexes.
// One thread at a time.
#pragma once

#include <assimp/scene.h>

#include <Eigen/Core>

#include "base/result.h"

namespace sim {

// Checks that indexes of vertices, meshes and bones are in range, that declared arrays exist, and that nodes nest at most deepest_node
// deep. Rejects a face with more than max_unchecked_corners corners if its mesh has too few vertices: Assimp fills a list that declares
// more numbers than its file has with zeros. It triangulates 65536 corners in 6 s, and this number in 1 s. The error is one line.
inline constexpr unsigned deepest_node = 1000;
inline constexpr unsigned max_unchecked_corners = 1 << 15;
base::Result<void> check_scene(const aiScene& scene);

// The error of a triangle with a corner that is not a number or too far away.
base::Error lost_corner(const Eigen::Vector3d& at);

// Removes faces without corners: Assimp takes them for polygons, and its triangulation crashes on them. Call it for a checked scene, before
// the steps of Assimp.
void drop_empty_faces(const aiScene& scene);

}  // namespace sim

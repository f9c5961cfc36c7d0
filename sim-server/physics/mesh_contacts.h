// Contacts between two meshes. ODE's own collider for them lets bodies slide off each other and sink in; here the corners of each feel for
// the faces of the other. Private to physics/. One thread at a time (ODE collides meshes through global buffers).
#pragma once

#include "physics/shapes.h"

namespace sim {

// Points of a mesh with the directions in which its faces look there; alike ones are taken together.
std::vector<MeshProbe> probes_of(const TriangleMesh& mesh);

// As dCollide: contacts with normals that push `a` away from `b`; their number.
int collide_meshes(const ShapeInstance& a, const ShapeInstance& b, int most, dContactGeom* contacts);

}  // namespace sim

// Contacts between two meshes. ODE's own collider for them returns depths and normals with which bodies gain energy; here the corners and
// the sharp edges of each feel how deep they are in the other. Private to physics/. Any thread.
#pragma once

#include "physics/shapes.h"
#include "physics/solid.h"

namespace sim {

// As dCollide: contacts with normals that push `a` away from `b`; their number.
int collide_meshes(const ShapeInstance& a, const Solid& solid_a, const ShapeInstance& b, const Solid& solid_b, int most,
                   dContactGeom* contacts);

}  // namespace sim

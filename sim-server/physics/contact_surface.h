// How two surfaces meet: friction, slip, bounce and softness of their contacts; and how many contacts are worth solving. Private to
// physics/. Pure functions; any thread.
#pragma once

#include <ode/ode.h>

#include <Eigen/Core>

#include "world/world_def.h"

namespace sim {

// Everything but the geometry of the contact. `dt` is the step.
dSurfaceParameters combine(const SurfaceDef& a, const SurfaceDef& b, double dt);

// Direction of the first friction axis in the contact's plane; false when neither surface asks for one.
bool friction_direction(const SurfaceDef& a, dGeomID geom_a, const SurfaceDef& b, dGeomID geom_b, const dReal* normal, dReal* out);

// Keeps the contacts that span the patch when all have about the same normal: at most four. Returns how many are left.
int reduce(dContactGeom* contacts, int count);

}  // namespace sim

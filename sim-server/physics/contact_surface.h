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

// Lets a contact that is harder give way by about 10 um under `weight` [N], so that bodies on more than three points load all of them:
// where nothing gives way the forces of the points are not determined, and the exact solver puts them all on some. `erp` and `layer` [m]
// are the world's; within that layer ODE would not push back, and the body would creep. What bounces stays hard.
void soften(dContact& contact, double weight, double erp, double layer, double dt);

// Friction that is the same in all directions acts against the sliding of `a` on `b` (null: what does not move): turns the first friction
// axis that way and lets the second one follow the sliding as it turns. ODE's own friction, a square with sides along the world's axes, is
// up to 1.4 times too strong and pulls sideways. `load` [N] is about what presses on the contact; it only decides how fast a turn of the
// sliding is followed. Does nothing where the surfaces have their own directions or slips.
void resist_sliding(dContact& contact, dBodyID a, dBodyID b, double load);

// Keeps the contacts that span the patch when all have about the same normal: at most four. Returns how many are left.
int reduce(dContactGeom* contacts, int count);

}  // namespace sim

// Contact of two surfaces: friction, slip, bounce and softness, and the number of contacts to solve. Private to physics/. Pure functions;
// any thread.
//
// Friction that is the same in all directions follows Coulomb: it acts against the sliding, whatever the direction, where ODE's own is a
// square along the world's axes. Hard contacts give way by some 10 um under the model's weight, so that all wheels of a robot carry it;
// without that the exact solver puts the load on any three points or two, and a robot on four wheels turns by fits and starts.
// Wheels touch below their middle and grip with a friction of 2 at most, whatever the world says: with an edge on each side and the
// friction of 1e5 that models have, the exact solver finds, rightly, that they cannot turn.
#pragma once

#include <ode/ode.h>

#include <Eigen/Core>

#include "physics/shapes.h"
#include "world/world_def.h"

namespace sim {

// Everything but the geometry of the contact. `dt` is the step.
dSurfaceParameters combine(const SurfaceDef& a, const SurfaceDef& b, double dt);

// Direction of the first friction axis in the contact's plane; false when neither surface asks for one.
bool friction_direction(const SurfaceDef& a, dGeomID geom_a, const SurfaceDef& b, dGeomID geom_b, const dReal* normal, dReal* out);

// The same for a wheel. A direction that turns with the wheel means the one in which it rolls, and nothing where the friction is the same
// in all directions; without any, the first axis is the axle's, as Gazebo has it for a robot that looks along x.
bool wheel_friction_direction(const SurfaceDef& wheel, dGeomID geom, const dSurfaceParameters& combined, const dReal* normal, dReal* out);

// The first friction axis of a contact: the shape's or the wheel's, or, of surfaces that give a frame for it, that of another link. Without
// any, the contact stays as it is.
void set_friction_direction(const ShapeInstance& a, const ShapeInstance& b, dContact& contact);

// A belt moves what touches it along with its surface. `is_of_a`: it is that of the first shape. Nothing where the contact is beside it.
void run_belt(const Belt& belt, bool is_of_a, dContact& contact);

// A wheel slips along its axle and in the direction in which it rolls, the more the faster it turns; standing it does not.
void let_slip(const WheelSlip& slip, dContact& contact);

// How deep two bodies may be in each other before their contact pushes back: the smaller of what their surfaces allow, as Gazebo has it,
// whatever <contact_surface_layer> says. What bounces is let in by a hair more, or it would part from what it rests on in every other step.
double allowed_depth(const SurfaceDef& a, const SurfaceDef& b, const dSurfaceParameters& combined);

// Lets a contact that is harder give way by about 10 um under `weight` [N], so that bodies on more than three points load all of them:
// where nothing gives way the forces of the points are not determined, and the exact solver puts them all on some. `erp` is the world's.
// What bounces stays hard.
void soften(dContact& contact, double weight, double erp, double dt);

// Friction that is the same in all directions acts against the sliding of `a` on `b` (null: what does not move): turns the first friction
// axis that way and lets the second one follow the sliding as it turns. ODE's own friction, a square with sides along the world's axes, is
// up to 1.4 times too strong and pulls sideways. `load` [N] is about what presses on the contact; it only decides how fast a turn of the
// sliding is followed. Does nothing where the surfaces have their own directions or slips.
void resist_sliding(dContact& contact, dBodyID a, dBodyID b, double load);

// Keeps the contacts that span the patch when all have about the same normal: at most four. Returns how many are left.
int reduce(dContactGeom* contacts, int count);

// A tyre touches with its whole width and is loaded most in the middle: contacts on the rolling face of the wheel become one, below the
// middle of the wheel. Contacts at both edges would each have to slip for the wheel to turn, the harder the wider it is, and a wheel that
// leans by a thousandth would stand on one edge. Returns how many are left.
int merge_under_wheel(dGeomID wheel, dContactGeom* contacts, int count);

// No tyre grips better. Worlds write 1e5 for "does not slip", with which a robot on four wheels could never turn.
inline constexpr double best_grip = 2;

}  // namespace sim

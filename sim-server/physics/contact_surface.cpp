#include "physics/contact_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "physics/ode.h"

namespace sim {
namespace {

Eigen::Vector3d velocity_at(dBodyID body, const dReal* place) {
  if (body == nullptr) return Eigen::Vector3d::Zero();
  dVector3 velocity;
  dBodyGetPointVel(body, place[0], place[1], place[2], velocity);
  return ode::vector(velocity);
}

}  // namespace

dSurfaceParameters combine(const SurfaceDef& a, const SurfaceDef& b, double dt) {
  dSurfaceParameters s{};
  s.mode = dContactApprox1 | dContactMu2;
  const auto friction = [](double x, double y) {
    const double mu = std::min(x, y);
    return std::isfinite(mu) && mu < 1e8 ? mu : dInfinity;
  };
  s.mu = friction(a.mu, b.mu);
  s.mu2 = friction(a.mu2, b.mu2);
  if (const double slip = std::max(a.slip1, b.slip1); slip > 0) s.mode |= dContactSlip1, s.slip1 = slip;
  if (const double slip = std::max(a.slip2, b.slip2); slip > 0) s.mode |= dContactSlip2, s.slip2 = slip;
  if (const double bounce = std::max(a.restitution, b.restitution); bounce > 0) {
    s.mode |= dContactBounce;
    s.bounce = std::min(bounce, 1.0);
    s.bounce_vel = std::min(a.bounce_threshold, b.bounce_threshold);
  }
  if (a.kp || b.kp) {
    // Springs in series, dampers side by side; then what ODE calls erp and cfm.
    const double soft_a = a.kp ? 1 / *a.kp : 0, soft_b = b.kp ? 1 / *b.kp : 0;
    const double kp = 1 / std::max(soft_a + soft_b, 1e-12);
    const double kd = a.kd.value_or(0) + b.kd.value_or(0);
    s.mode |= dContactSoftERP | dContactSoftCFM;
    s.soft_erp = std::min(dt * kp / (dt * kp + kd), 0.8);
    s.soft_cfm = 1 / (dt * kp + kd);
  } else if (a.soft_cfm > 0 || b.soft_cfm > 0) {
    s.mode |= dContactSoftERP | dContactSoftCFM;
    s.soft_cfm = std::max(a.soft_cfm, b.soft_cfm);
    s.soft_erp = std::min(a.soft_erp, b.soft_erp);
  }
  return s;
}

bool friction_direction(const SurfaceDef& a, dGeomID geom_a, const SurfaceDef& b, dGeomID geom_b, const dReal* normal, dReal* out) {
  const bool from_a = a.friction_direction.has_value();
  if (!from_a && !b.friction_direction) return false;
  dQuaternion q;
  const dGeomID geom = from_a ? geom_a : geom_b;
  if (dGeomGetClass(geom) == dPlaneClass) return false;
  dGeomGetQuaternion(geom, q);
  const Eigen::Vector3d n(normal[0], normal[1], normal[2]);
  Eigen::Vector3d direction = ode::quaternion(q) * (from_a ? *a.friction_direction : *b.friction_direction);
  direction -= n * n.dot(direction);
  if (direction.norm() < 1e-6) return false;
  direction.normalize();
  out[0] = direction.x(), out[1] = direction.y(), out[2] = direction.z();
  return true;
}

bool wheel_friction_direction(const SurfaceDef& wheel, dGeomID geom, const dSurfaceParameters& combined, const dReal* normal, dReal* out) {
  const bool is_even = combined.mu == combined.mu2 && (combined.mode & (dContactSlip1 | dContactSlip2)) == 0;
  const bool is_of_axle = !wheel.friction_direction || std::abs(wheel.friction_direction->z()) > 0.7;
  if (is_even && (!wheel.friction_direction || !is_of_axle)) return false;
  const dReal* r = dGeomGetRotation(geom);
  const Eigen::Vector3d axle(r[2], r[6], r[10]), n(normal[0], normal[1], normal[2]);
  const Eigen::Vector3d rolling = axle.cross(n);
  if (!(rolling.norm() > 0.1)) return false;  // it lies on its side
  const Eigen::Vector3d direction = (is_of_axle ? n.cross(rolling) : rolling).normalized();
  out[0] = direction.x(), out[1] = direction.y(), out[2] = direction.z();
  return true;
}

namespace {

// Along the contact's plane. False when nothing is left of it there.
bool lay(const Eigen::Vector3d& direction, dContact& contact) {
  const Eigen::Vector3d normal = ode::vector(contact.geom.normal);
  const Eigen::Vector3d in_plane = direction - normal * normal.dot(direction);
  if (!(in_plane.norm() > 1e-6)) return false;
  const Eigen::Vector3d unit = in_plane.normalized();
  for (int k = 0; k < 3; ++k) contact.fdir1[k] = unit[k];
  contact.surface.mode |= dContactFDir1;
  return true;
}

}  // namespace

void set_friction_direction(const ShapeInstance& a, const ShapeInstance& b, dContact& contact) {
  for (const ShapeInstance* shape : {&a, &b}) {
    const FrictionFrame* frame = shape->friction_frame.get();
    if (frame == nullptr) continue;
    static_cast<void>(
        lay(frame->body != nullptr ? ode::quaternion(dBodyGetQuaternion(frame->body)) * frame->direction : frame->in_world, contact));
    return;
  }
  const ShapeInstance* wheel = a.is_wheel ? &a : b.is_wheel ? &b : nullptr;
  const dReal* normal = contact.geom.normal;
  if (wheel != nullptr ? wheel_friction_direction(*wheel->surface, wheel->geom.id(), contact.surface, normal, contact.fdir1)
                       : friction_direction(*a.surface, a.geom.id(), *b.surface, b.geom.id(), normal, contact.fdir1))
    contact.surface.mode |= dContactFDir1;
}

void run_belt(const Belt& belt, bool is_of_a, dContact& contact) {
  constexpr double beside = 0.1;                                                     // sine of the angle between its axis and the normal
  const Eigen::Vector3d up = ode::vector(contact.geom.normal) * (is_of_a ? 1 : -1);  // into the belt's link
  const Eigen::Vector3d forward = belt.axis.cross(up);
  if (!(forward.norm() > beside)) return;
  Eigen::Vector3d direction = forward;
  if (belt.center) direction = up.cross(ode::vector(contact.geom.pos) - *belt.center);
  if (!lay(direction, contact) && !lay(forward, contact)) return;
  if (belt.is_free) {
    contact.surface.mu = 0;
    return;
  }
  const double speed = ode::vector(contact.fdir1).dot(forward) < 0 ? -belt.speed : belt.speed;
  contact.surface.mode |= dContactMotion1;
  contact.surface.motion1 = is_of_a ? speed : -speed;
}

void let_slip(const WheelSlip& slip, dContact& contact) {
  const Eigen::Vector3d axle = ode::quaternion(dBodyGetQuaternion(slip.wheel)) * slip.axle;
  const Eigen::Vector3d rate =
      ode::vector(dBodyGetAngularVel(slip.wheel)) -
      (slip.carrier_body != nullptr ? ode::vector(dBodyGetAngularVel(slip.carrier_body)) : Eigen::Vector3d(0, 0, 0));
  const double spin = std::abs(axle.dot(rate));
  const Eigen::Vector3d rolling = axle.cross(ode::vector(contact.geom.normal));
  if (!(spin > 1e-6) || !(rolling.norm() > 0.1)) return;
  dSurfaceParameters& surface = contact.surface;
  if (slip.is_rolling_first) std::swap(surface.mu, surface.mu2);
  static_cast<void>(lay(ode::vector(contact.geom.normal).cross(rolling), contact));
  surface.slip1 = spin * slip.lateral;
  surface.slip2 = spin * slip.longitudinal;
  if (surface.slip1 > 0) surface.mode |= dContactSlip1;
  if (surface.slip2 > 0) surface.mode |= dContactSlip2;
}

double allowed_depth(const SurfaceDef& a, const SurfaceDef& b, const dSurfaceParameters& combined) {
  constexpr double hair = 1e-4;  // [m]
  const double depth = std::min(a.min_depth, b.min_depth);
  return (combined.mode & dContactBounce) != 0 ? std::max(depth, hair) : depth;
}

void soften(dContact& contact, double weight, double erp, double dt) {
  constexpr double sag = 1e-5;  // [m]
  dSurfaceParameters& surface = contact.surface;
  if (!(weight > 0) || !(erp > 0) || (surface.mode & dContactBounce) != 0) return;
  const double cfm = erp * sag / (dt * weight);
  if ((surface.mode & dContactSoftCFM) != 0 && surface.soft_cfm >= cfm) return;
  surface.mode |= dContactSoftERP | dContactSoftCFM;
  surface.soft_cfm = cfm;
  surface.soft_erp = erp;
}

void resist_sliding(dContact& contact, dBodyID a, dBodyID b, double load) {
  constexpr double at_rest = 1e-6;  // [m/s]
  dSurfaceParameters& surface = contact.surface;
  if ((surface.mode & (dContactFDir1 | dContactSlip1 | dContactSlip2)) != 0 || surface.mu != surface.mu2) return;
  if (!(surface.mu > 0) || surface.mu == dInfinity || !(load > 0)) return;
  const Eigen::Vector3d normal = ode::vector(contact.geom.normal);
  Eigen::Vector3d sliding = velocity_at(a, contact.geom.pos) - velocity_at(b, contact.geom.pos);
  sliding -= normal * normal.dot(sliding);
  const double speed = sliding.norm();
  if (!(speed > at_rest)) return;
  for (int i = 0; i < 3; ++i) contact.fdir1[i] = sliding[i] / speed;
  // The force turns with the sliding: what of the velocity comes to lie across takes its share of the friction with it.
  surface.mode |= dContactFDir1 | dContactSlip2;
  surface.slip2 = speed / (surface.mu * load);
}

int reduce(dContactGeom* contacts, int count) {
  if (count <= 4) return count;
  const auto position = [&](int i) { return ode::vector(contacts[i].pos); };
  const Eigen::Vector3d normal = ode::vector(contacts[0].normal);
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (int i = 0; i < count; ++i) {
    if (normal.dot(ode::vector(contacts[i].normal)) < 0.98) return count;
    middle += position(i) / count;
  }
  const auto best = [&](auto score) {
    int found = 0;
    double most = -infinite;
    for (int i = 0; i < count; ++i) {
      if (const double s = score(position(i)); s > most) most = s, found = i;
    }
    return found;
  };
  // By place alone: depths of a resting body differ by noise, and a choice that jumps makes it creep.
  const int first = best([&](const Eigen::Vector3d& p) { return (p - middle).squaredNorm(); });
  const Eigen::Vector3d a = position(first);
  const int second = best([&](const Eigen::Vector3d& p) { return (p - a).squaredNorm(); });
  const Eigen::Vector3d along = position(second) - a;
  const Eigen::Vector3d across = normal.cross(along);
  const int third = best([&](const Eigen::Vector3d& p) { return across.dot(p - a); });
  const int fourth = best([&](const Eigen::Vector3d& p) { return -across.dot(p - a); });
  int chosen[4] = {first, second, third, fourth};
  std::sort(chosen, chosen + 4);
  const int kept = static_cast<int>(std::unique(chosen, chosen + 4) - chosen);
  for (int i = 0; i < kept; ++i) contacts[i] = contacts[chosen[i]];  // ascending, so nothing is overwritten too early
  return kept;
}

int merge_under_wheel(dGeomID wheel, dContactGeom* contacts, int count) {
  constexpr double max_lean = 0.05;  // [rad] at which the tyre still touches with its whole width
  const dReal* r = dGeomGetRotation(wheel);
  const Eigen::Vector3d axle(r[2], r[6], r[10]), middle = ode::vector(dGeomGetPosition(wheel));
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    dContactGeom contact = contacts[i];
    const Eigen::Vector3d normal = ode::vector(contact.normal);
    if (!(std::abs(normal.dot(axle)) < max_lean)) {
      contacts[kept++] = contact;
      continue;
    }
    const Eigen::Vector3d place = ode::vector(contact.pos) - axle * axle.dot(ode::vector(contact.pos) - middle);
    for (int k = 0; k < 3; ++k) contact.pos[k] = place[k];
    int same = 0;
    while (same < kept && normal.dot(ode::vector(contacts[same].normal)) < 0.98) ++same;
    if (same == kept) {
      contacts[kept++] = contact;
    } else if (contact.depth > contacts[same].depth) {
      contacts[same] = contact;
    }
  }
  return kept;
}

}  // namespace sim

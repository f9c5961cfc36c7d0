#include "physics/mesh_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace sim {
namespace {

constexpr std::size_t most_probes = 4000;  // finer meshes are left to ODE
constexpr double deepest = 0.05;           // [m] that a corner may be behind a face

// Corners of `a` behind faces of `b`. `sense` turns the normals so that they push the first of the pair.
void feel(const ShapeInstance& a, const ShapeInstance& b, double sense, int most, dContactGeom* contacts, int& count) {
  const auto& mesh = *static_cast<const ShapeStore::Mesh*>(a.data.get());
  dQuaternion q;
  dGeomGetQuaternion(a.geom.id(), q);
  const Eigen::Matrix3d rotation = ode::quaternion(q).toRotationMatrix();
  const Eigen::Vector3d position = ode::vector(dGeomGetPosition(a.geom.id()));
  // Not so far back that the ray begins on the other side of a thin body.
  const double reach = std::min(deepest, 0.3 * std::min((a.box.high - a.box.low).minCoeff(), (b.box.high - b.box.low).minCoeff()));
  if (!(reach > 1e-6)) return;
  const ode::Geom ray(dCreateRay(nullptr, reach));
  dGeomRaySetClosestHit(ray.id(), 1);
  dGeomRaySetBackfaceCull(ray.id(), 1);
  const Eigen::Vector3d low = b.box.low.array() - 1e-6, high = b.box.high.array() + 1e-6;
  for (const MeshProbe& probe : mesh.probes) {
    if (count >= most) return;
    const Eigen::Vector3d place = position + rotation * probe.place;
    if ((place.array() < low.array()).any() || (place.array() > high.array()).any()) continue;
    const Eigen::Vector3d outward = rotation * probe.outward, from = place - reach * outward;
    dGeomRaySet(ray.id(), from.x(), from.y(), from.z(), outward.x(), outward.y(), outward.z());
    dContactGeom hit;
    if (dCollide(ray.id(), b.geom.id(), 1, &hit, sizeof hit) < 1) continue;
    Eigen::Vector3d normal = ode::vector(hit.normal);
    const double facing = -normal.dot(outward);
    if (facing < 0.2 || hit.depth > reach) continue;
    dContactGeom& contact = contacts[count++];
    contact = {};
    contact.depth = (reach - hit.depth) * facing;
    normal *= sense;
    for (int i = 0; i < 3; ++i) contact.pos[i] = place[i], contact.normal[i] = normal[i];
    contact.g1 = sense > 0 ? a.geom.id() : b.geom.id();
    contact.g2 = sense > 0 ? b.geom.id() : a.geom.id();
  }
}

}  // namespace

std::vector<MeshProbe> probes_of(const TriangleMesh& mesh) {
  std::vector<MeshProbe> probes;
  if (mesh.vertices.size() > most_probes) return probes;
  // Corners are doubled where faces have normals or colours of their own.
  std::map<std::array<double, 3>, std::vector<MeshProbe>> corners;
  for (const auto& triangle : mesh.triangles) {
    const Eigen::Vector3d &a = mesh.vertices[triangle[0]], &b = mesh.vertices[triangle[1]], &c = mesh.vertices[triangle[2]];
    const Eigen::Vector3d cross = (b - a).cross(c - a);
    if (!(cross.norm() > 1e-14)) continue;
    const Eigen::Vector3d outward = cross.normalized();
    for (const Eigen::Vector3d& corner : {a, b, c}) {
      auto& there = corners[{corner.x(), corner.y(), corner.z()}];
      const auto alike = std::find_if(there.begin(), there.end(), [&](const MeshProbe& p) { return p.outward.dot(outward) > 0.9; });
      if (alike == there.end()) there.push_back({corner, outward});
    }
  }
  for (const auto& [place, there] : corners) probes.insert(probes.end(), there.begin(), there.end());
  if (probes.size() > most_probes) probes.clear();
  return probes;
}

int collide_meshes(const ShapeInstance& a, const ShapeInstance& b, int most, dContactGeom* contacts) {
  const auto has_probes = [](const ShapeInstance& shape) {
    return !static_cast<const ShapeStore::Mesh*>(shape.data.get())->probes.empty();
  };
  int count = 0;
  if (has_probes(a) && has_probes(b)) {
    feel(a, b, 1, most, contacts, count);
    feel(b, a, -1, most, contacts, count);
  }
  // Edges across each other, and bodies deep in each other.
  return count > 0 ? count : dCollide(a.geom.id(), b.geom.id(), most, contacts, sizeof(dContactGeom));
}

}  // namespace sim

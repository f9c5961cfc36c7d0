#include "physics/shapes.h"

#include <algorithm>
#include <numbers>

#include "world/reported_files.h"

namespace sim {

namespace {

constexpr double ground_below = 10;  // [m] of solid ground under the lowest place of a height field

// ODE's own box is too small for a field that is turned and not square. Its heights are along y.
Aabb box_of_field(dGeomID geom, const ShapeStore::Field& field) {
  const auto [low, high] = std::minmax_element(field.grid->heights.begin(), field.grid->heights.end());
  const Eigen::Vector3d middle(0, (*low - ground_below + *high) / 2, 0);
  const Eigen::Vector3d half(field.grid->width / 2, (*high - *low + ground_below) / 2, field.grid->depth / 2);
  const dReal* p = dGeomGetPosition(geom);
  const dReal* r = dGeomGetRotation(geom);
  Aabb box;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
    const Eigen::Vector3d q = middle + sign.cwiseProduct(half);
    const Eigen::Vector3d at(p[0] + r[0] * q.x() + r[1] * q.y() + r[2] * q.z(), p[1] + r[4] * q.x() + r[5] * q.y() + r[6] * q.z(),
                             p[2] + r[8] * q.x() + r[9] * q.y() + r[10] * q.z());
    box.extend({at, at});
  }
  return box;
}

// Triangles with three corners, and the vertices that they use: ODE ends the process when a mesh has more vertices than edges.
void fill(ShapeStore::Mesh& mesh, const TriangleMesh& from) {
  constexpr dTriIndex unused = ~dTriIndex{0};
  const auto has_corners = [](const auto& t) { return t[0] != t[1] && t[1] != t[2] && t[2] != t[0]; };
  std::vector<dTriIndex> places(from.vertices.size(), unused);
  for (const auto& triangle : from.triangles) {
    if (!has_corners(triangle)) continue;
    for (const auto corner : triangle) places[corner] = 0;
  }
  mesh.vertices.reserve(from.vertices.size() * 3);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] == unused) continue;
    places[i] = static_cast<dTriIndex>(mesh.vertices.size() / 3);
    mesh.vertices.insert(mesh.vertices.end(), {from.vertices[i].x(), from.vertices[i].y(), from.vertices[i].z()});
  }
  for (const auto& t : from.triangles)
    if (has_corners(t)) mesh.indexes.insert(mesh.indexes.end(), {places[t[0]], places[t[1]], places[t[2]]});
}

// The line about a collision is the one about its file.
base::Error missed(const std::string& path, const base::Error& why) {
  static_cast<void>(is_first_report(path));
  return why;
}

}  // namespace

Aabb box_of(dGeomID geom) {
  if (dGeomGetClass(geom) == dHeightfieldClass) return box_of_field(geom, *static_cast<const ShapeStore::Field*>(dGeomGetData(geom)));
  dReal b[6];
  dGeomGetAABB(geom, b);
  return {{b[0], b[2], b[4]}, {b[1], b[3], b[5]}};
}

Eigen::AlignedBox3d box_of(const ShapeInstance& shape, const GeometryDef& geometry, const Eigen::Isometry3d& place) {
  const auto around = [](const Eigen::Vector3d& middle, const Eigen::Vector3d& reach) {
    return Eigen::AlignedBox3d((middle - reach).eval(), (middle + reach).eval());
  };
  const Eigen::Matrix3d turn = place.linear().cwiseAbs();
  const Eigen::Vector3d middle = place.translation(), axis = turn.col(2);
  if (const auto* box = std::get_if<BoxShape>(&geometry)) return around(middle, turn * box->size / 2);
  if (const auto* sphere = std::get_if<SphereShape>(&geometry)) return around(middle, Eigen::Vector3d::Constant(sphere->radius));
  if (const auto* capsule = std::get_if<CapsuleShape>(&geometry))
    return around(middle, axis * capsule->length / 2 + Eigen::Vector3d::Constant(capsule->radius));
  if (const auto* cylinder = std::get_if<CylinderShape>(&geometry)) {
    const Eigen::Vector3d disc = (1 - axis.array().square()).max(0).sqrt() * cylinder->radius;
    return around(middle, axis * cylinder->length / 2 + disc);
  }
  if (const auto* plane = std::get_if<PlaneShape>(&geometry)) {
    constexpr double along_axis = 1 - 1e-9;
    Eigen::AlignedBox3d box(Eigen::Vector3d::Constant(-infinite), Eigen::Vector3d::Constant(infinite));
    const Eigen::Vector3d normal = place.linear() * plane->normal;
    for (int i = 0; i < 3; ++i) {
      if (normal[i] > along_axis) box.max()[i] = middle[i];
      if (normal[i] < -along_axis) box.min()[i] = middle[i];
    }
    return box;
  }
  if (const auto* map = std::get_if<HeightmapShape>(&geometry)) {
    const HeightGrid& grid = *static_cast<const ShapeStore::Field*>(shape.data.get())->grid;
    const auto [lowest, highest] = std::minmax_element(grid.heights.begin(), grid.heights.end());
    const double low = *lowest, high = *highest;
    return around(place * (map->position + Eigen::Vector3d(0, 0, (low + high) / 2)),
                  turn * Eigen::Vector3d(grid.width, grid.depth, high - low) / 2);
  }
  Eigen::AlignedBox3d box;
  const auto& vertices = static_cast<const ShapeStore::Mesh*>(shape.data.get())->vertices;
  for (std::size_t i = 0; i + 2 < vertices.size(); i += 3)
    box.extend(place * Eigen::Vector3d(vertices[i], vertices[i + 1], vertices[i + 2]));
  return box;
}

base::Result<std::shared_ptr<ShapeStore::Mesh>> ShapeStore::mesh(const GeometryDef& geometry) {
  const auto triangles = triangles_.triangles(geometry);
  if (!triangles) return triangles.error();
  const bool is_cached = std::holds_alternative<MeshShape>(geometry);
  if (const auto found = meshes_.find(triangles->get()); is_cached && found != meshes_.end()) return found->second;
  auto mesh = std::make_shared<Mesh>();
  fill(*mesh, **triangles);
  if (mesh->indexes.empty()) return base::Error{"mesh: has no triangle with three corners"};
  mesh->triangles = *triangles;
  mesh->data = ode::TriMeshData(dGeomTriMeshDataCreate());
  dGeomTriMeshDataBuildDouble(mesh->data.id(), mesh->vertices.data(), 3 * sizeof(double), static_cast<int>(mesh->vertices.size() / 3),
                              mesh->indexes.data(), static_cast<int>(mesh->indexes.size()), 3 * sizeof(dTriIndex));
  dGeomTriMeshDataPreprocess2(mesh->data.id(), 1U << dTRIDATAPREPROCESS_BUILD_FACE_ANGLES, nullptr);
  if (is_cached) meshes_[triangles->get()] = mesh;
  return mesh;
}

base::Result<std::shared_ptr<ShapeStore::Field>> ShapeStore::field(const HeightmapShape& shape) {
  const auto grid = triangles_.heights(shape);
  if (!grid) return grid.error();
  if (const auto found = fields_.find(grid->get()); found != fields_.end()) return found->second;
  auto field = std::make_shared<Field>();
  field->grid = *grid;
  field->data = ode::HeightfieldData(dGeomHeightfieldDataCreate());
  const HeightGrid& g = **grid;
  dGeomHeightfieldDataBuildSingle(field->data.id(), g.heights.data(), 0, g.width, g.depth, g.columns, g.rows, 1, 0, ground_below, 0);
  const auto [low, high] = std::minmax_element(g.heights.begin(), g.heights.end());
  dGeomHeightfieldDataSetBounds(field->data.id(), *low - ground_below, *high);
  fields_[grid->get()] = field;
  return field;
}

base::Result<ShapeInstance> make_shape(const CollisionDef& collision, ShapeStore& shapes) {
  ShapeInstance shape;
  shape.surface = &collision.surface;
  const GeometryDef& geometry = collision.geometry;
  if (const auto* box = std::get_if<BoxShape>(&geometry)) {
    shape.geom = ode::Geom(dCreateBox(nullptr, box->size.x(), box->size.y(), box->size.z()));
  } else if (const auto* sphere = std::get_if<SphereShape>(&geometry)) {
    shape.geom = ode::Geom(dCreateSphere(nullptr, sphere->radius));
  } else if (const auto* cylinder = std::get_if<CylinderShape>(&geometry)) {
    shape.geom = ode::Geom(dCreateCylinder(nullptr, cylinder->radius, cylinder->length));
  } else if (const auto* capsule = std::get_if<CapsuleShape>(&geometry)) {
    shape.geom = ode::Geom(dCreateCapsule(nullptr, capsule->radius, capsule->length));
  } else if (const auto* plane = std::get_if<PlaneShape>(&geometry)) {
    shape.geom = ode::Geom(dCreatePlane(nullptr, plane->normal.x(), plane->normal.y(), plane->normal.z(), 0));
  } else if (const auto* map = std::get_if<HeightmapShape>(&geometry)) {
    auto field = shapes.field(*map);
    if (!field) return missed(map->path, field.error());
    shape.geom = ode::Geom(dCreateHeightfield(nullptr, (*field)->data.id(), 1));
    shape.data = *field;
    dGeomSetData(shape.geom.id(), field->get());  // for box_of; lives as long as the shape
    shape.needs_lock = true;
  } else {
    auto mesh = shapes.mesh(geometry);
    if (!mesh) return std::holds_alternative<MeshShape>(geometry) ? missed(std::get<MeshShape>(geometry).path, mesh.error()) : mesh.error();
    shape.geom = ode::Geom(dCreateTriMesh(nullptr, (*mesh)->data.id(), nullptr, nullptr, nullptr));
    shape.data = *mesh;
    shape.needs_lock = true;
  }
  return shape;
}

// ODE's height fields point along y.
Eigen::Isometry3d geom_in_collision(const GeometryDef& geometry) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  if (const auto* map = std::get_if<HeightmapShape>(&geometry)) {
    pose.translation() = map->position;
    pose.rotate(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
  }
  return pose;
}

}  // namespace sim

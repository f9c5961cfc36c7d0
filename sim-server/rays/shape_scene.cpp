#include "rays/shape_scene.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cstring>

namespace sim {
namespace {

using embree::Geometry;

Geometry triangles(RTCDevice device, const std::vector<Eigen::Vector3d>& vertices, const std::vector<std::array<std::uint32_t, 3>>& faces,
                   const Eigen::Isometry3d& pose) {
  Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, vertices.size()));
  auto* f =
      static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, faces.size()));
  if (v == nullptr || f == nullptr) return nullptr;
  for (const auto& vertex : vertices) {
    const Eigen::Vector3f p = (pose * vertex).cast<float>();
    *v++ = p.x(), *v++ = p.y(), *v++ = p.z();
  }
  std::memcpy(f, faces.data(), faces.size() * 12);
  return geometry;
}

Geometry box(RTCDevice device, const Eigen::Vector3d& size, const Eigen::Isometry3d& pose) {
  std::vector<Eigen::Vector3d> vertices;
  for (int i = 0; i < 8; ++i) vertices.emplace_back(Eigen::Vector3d((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2) - 0.5).cwiseProduct(size));
  static const std::vector<std::array<std::uint32_t, 3>> faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                                                  {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return triangles(device, vertices, faces, pose);
}

Geometry sphere(RTCDevice device, double radius, const Eigen::Isometry3d& pose) {
  Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT));
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 1));
  const Eigen::Vector3f p = pose.translation().cast<float>();
  v[0] = p.x(), v[1] = p.y(), v[2] = p.z(), v[3] = static_cast<float>(radius);
  return geometry;
}

// A cylinder with flat ends (a cone of equal radii) or round ones.
Geometry rod(RTCDevice device, RTCGeometryType type, double radius, double length, const Eigen::Isometry3d& pose) {
  Geometry geometry(rtcNewGeometry(device, type));
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 2));
  auto* i = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, 4, 1));
  for (int end = 0; end < 2; ++end) {
    const Eigen::Vector3f p = (pose * Eigen::Vector3d(0, 0, (end - 0.5) * length)).cast<float>();
    v[4 * end] = p.x(), v[4 * end + 1] = p.y(), v[4 * end + 2] = p.z(), v[4 * end + 3] = static_cast<float>(radius);
  }
  i[0] = 0;
  return geometry;
}

}  // namespace

ShapeScene::ShapeScene(RTCDevice device, RTCBuildQuality quality) : scene(rtcNewScene(device)) {
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene.get(), quality);
}

unsigned ShapeScene::add(const Geometry& geometry, const Look& look) {
  rtcCommitGeometry(geometry.get());
  const unsigned id = rtcAttachGeometry(scene.get(), geometry.get());
  if (looks.size() <= id) looks.resize(id + 1);
  looks[id] = look;
  return id;
}

Geometry make_geometry(RTCDevice device, const GeometryDef& g, const Eigen::Isometry3d& pose, TriangleCache& cache,
                       std::vector<std::string>& notes) {
  if (const auto* b = std::get_if<BoxShape>(&g)) return box(device, b->size, pose);
  if (const auto* s = std::get_if<SphereShape>(&g)) return sphere(device, s->radius, pose);
  if (const auto* c = std::get_if<CylinderShape>(&g)) return rod(device, RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE, c->radius, c->length, pose);
  if (const auto* p = std::get_if<CapsuleShape>(&g)) return rod(device, RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE, p->radius, p->length, pose);
  // Fine enough for lidars: a few tenths of a millimetre on an ellipsoid of a metre.
  if (const auto* e = std::get_if<EllipsoidShape>(&g)) {
    const TriangleMesh mesh = ellipsoid_triangles(e->radii, 96, 192);
    return triangles(device, mesh.vertices, mesh.triangles, pose);
  }
  const auto mesh = cache.triangles(g);
  if (!mesh) {
    notes.push_back(mesh.error().message + "; rays do not see it");
    return nullptr;
  }
  return triangles(device, (*mesh)->vertices, (*mesh)->triangles, pose);
}

std::string key_of(std::span<const RayShape> shapes) {
  std::string key;
  for (const auto& shape : shapes) {
    const Eigen::Matrix4d& m = shape.pose.matrix();
    key.append(reinterpret_cast<const char*>(m.data()), sizeof(double) * 16);
    key += fmt::format("|{}|{}|{}|", shape.retro, shape.color, shape.geometry->index());
    const auto numbers = [&](auto... values) { ((key += fmt::format("{},", values)), ...); };
    if (const auto* b = std::get_if<BoxShape>(shape.geometry)) numbers(b->size.x(), b->size.y(), b->size.z());
    if (const auto* s = std::get_if<SphereShape>(shape.geometry)) numbers(s->radius);
    if (const auto* c = std::get_if<CylinderShape>(shape.geometry)) numbers(c->radius, c->length);
    if (const auto* c = std::get_if<CapsuleShape>(shape.geometry)) numbers(c->radius, c->length);
    if (const auto* e = std::get_if<EllipsoidShape>(shape.geometry)) numbers(e->radii.x(), e->radii.y(), e->radii.z());
    if (const auto* m2 = std::get_if<MeshShape>(shape.geometry)) {
      key += m2->path + "|" + m2->submesh;
      numbers(m2->scale.x(), m2->scale.y(), m2->scale.z(), m2->center_submesh);
    }
    if (const auto* p = std::get_if<PolylineShape>(shape.geometry)) {
      numbers(p->height);
      for (const auto& outline : p->outlines) {
        for (const auto& corner : outline) numbers(corner.x(), corner.y());
        key += '/';
      }
    }
  }
  return key;
}

}  // namespace sim

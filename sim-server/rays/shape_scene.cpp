#include "rays/shape_scene.h"

#include <spdlog/fmt/fmt.h>

#include <array>
#include <cstring>

#include "world/reported_files.h"

namespace sim {
namespace {

using embree::Geometry;

Geometry triangles(RTCDevice device, const std::vector<Eigen::Vector3d>& vertices, const std::vector<std::array<std::uint32_t, 3>>& faces,
                   const Eigen::Isometry3d& pose) {
  Geometry geometry(embree::made(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE)));
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

// Six faces with four corners each. Every face goes on for `flap` past its edges, so that no ray slips through an edge between two faces
// where rounding puts it outside of both.
Geometry box(RTCDevice device, const Eigen::Vector3d& size, const Eigen::Isometry3d& pose) {
  const double flap = 1e-5 + 1e-6 * pose.translation().norm();  // [m]; above what floats round off there
  Geometry geometry(embree::made(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD)));
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, 24));
  auto* f = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 16, 6));
  if (v == nullptr || f == nullptr) return nullptr;
  const Eigen::Vector3d half = size / 2;
  for (int face = 0; face < 6; ++face) {
    const int normal = face / 2, first = (normal + 1 + face % 2) % 3, second = 3 - normal - first;  // counter-clockwise from outside
    for (int corner = 0; corner < 4; ++corner) {
      Eigen::Vector3d place;
      place[normal] = face % 2 == 0 ? half[normal] : -half[normal];
      place[first] = (corner == 1 || corner == 2 ? 1 : -1) * (half[first] + flap);
      place[second] = (corner >= 2 ? 1 : -1) * (half[second] + flap);
      const Eigen::Vector3f p = (pose * place).cast<float>();
      *v++ = p.x(), *v++ = p.y(), *v++ = p.z();
      *f++ = static_cast<std::uint32_t>(4 * face + corner);
    }
  }
  return geometry;
}

Geometry sphere(RTCDevice device, double radius, const Eigen::Isometry3d& pose) {
  Geometry geometry(embree::made(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT)));
  auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 1));
  const Eigen::Vector3f p = pose.translation().cast<float>();
  v[0] = p.x(), v[1] = p.y(), v[2] = p.z(), v[3] = static_cast<float>(radius);
  return geometry;
}

// A cylinder with flat ends (a cone of equal radii) or round ones.
Geometry rod(RTCDevice device, RTCGeometryType type, double radius, double length, const Eigen::Isometry3d& pose) {
  Geometry geometry(embree::made(rtcNewGeometry(device, type)));
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

ShapeScene::ShapeScene(RTCDevice device, RTCBuildQuality quality) : scene(embree::made(rtcNewScene(device))) {
  rtcSetSceneBuildQuality(scene.get(), quality);
}

unsigned ShapeScene::add(const Geometry& geometry, const GeometryDef& shape, const Look& look) {
  const bool has_seams = !std::holds_alternative<BoxShape>(shape) && !std::holds_alternative<SphereShape>(shape) &&
                         !std::holds_alternative<CylinderShape>(shape) && !std::holds_alternative<CapsuleShape>(shape);
  if (has_seams) rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
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
  if (const auto* c = std::get_if<ConeShape>(&g)) {
    const TriangleMesh mesh = cone_triangles(*c, 192);
    return triangles(device, mesh.vertices, mesh.triangles, pose);
  }
  const auto mesh = cache.triangles(g);
  if (!mesh) {
    const auto* file = std::get_if<MeshShape>(&g);
    if (file == nullptr || is_first_report(file->path)) notes.push_back(mesh.error().message + "; rays do not see it");
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
    if (const auto* c = std::get_if<ConeShape>(shape.geometry)) numbers(c->radius, c->length);
    if (const auto* e = std::get_if<EllipsoidShape>(shape.geometry)) numbers(e->radii.x(), e->radii.y(), e->radii.z());
    if (const auto* m2 = std::get_if<MeshShape>(shape.geometry)) {
      key += m2->path + "|" + m2->submesh;
      numbers(m2->scale.x(), m2->scale.y(), m2->scale.z(), m2->center_submesh, m2->version);
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

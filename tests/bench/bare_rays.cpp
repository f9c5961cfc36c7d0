#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "bare_loops.h"

namespace sim::bench {

struct BareRays::State {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::size_t beams = 0;
  float far = 0;
  std::vector<float> x, y;

  void add_triangles(const TriangleMesh& mesh, const Eigen::Isometry3d& pose) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v =
        static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, mesh.vertices.size()));
    auto* f =
        static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, mesh.triangles.size()));
    for (const auto& vertex : mesh.vertices) {
      const Eigen::Vector3f p = (pose * vertex).cast<float>();
      *v++ = p.x(), *v++ = p.y(), *v++ = p.z();
    }
    for (const auto& triangle : mesh.triangles) *f++ = triangle[0], *f++ = triangle[1], *f++ = triangle[2];
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }

  void add_rod(const CylinderShape& cylinder, const Eigen::Isometry3d& pose) const {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE);
    auto* v = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, 2));
    auto* i = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, 4, 1));
    for (const double end : {-0.5, 0.5}) {
      const Eigen::Vector3f p = (pose * Eigen::Vector3d(0, 0, end * cylinder.length)).cast<float>();
      *v++ = p.x(), *v++ = p.y(), *v++ = p.z(), *v++ = static_cast<float>(cylinder.radius);
    }
    *i = 0;
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
};

namespace {

TriangleMesh box_triangles(const Eigen::Vector3d& size) {
  TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back(Eigen::Vector3d((i & 1) - 0.5, (i >> 1 & 1) - 0.5, (i >> 2) - 0.5).cwiseProduct(size));
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace

BareRays::BareRays(const WorldDef& world, TriangleCache& triangles) : state_(std::make_unique<State>()) {
  state_->device = rtcNewDevice("threads=1,start_threads=0");
  state_->scene = rtcNewScene(state_->device);
  rtcSetSceneBuildQuality(state_->scene, RTC_BUILD_QUALITY_HIGH);
  for (const auto& model : world.models) {
    if (!model.is_static) continue;
    for (const auto& link : model.links) {
      for (const auto& collision : link.collisions) {
        const Eigen::Isometry3d pose = model.pose * link.pose * collision.pose;
        if (const auto* box = std::get_if<BoxShape>(&collision.geometry)) state_->add_triangles(box_triangles(box->size), pose);
        if (const auto* rod = std::get_if<CylinderShape>(&collision.geometry)) state_->add_rod(*rod, pose);
        if (std::holds_alternative<MeshShape>(collision.geometry))
          state_->add_triangles(*triangles.triangles(collision.geometry).value(), pose);
      }
    }
  }
  rtcCommitScene(state_->scene);
}

BareRays::~BareRays() {
  rtcReleaseScene(state_->scene);
  rtcReleaseDevice(state_->device);
}

void BareRays::aim(int beams, double from, double to, float far) {
  state_->beams = static_cast<std::size_t>(beams);
  state_->far = far;
  state_->x.assign((state_->beams + 15) / 16 * 16, 1);
  state_->y.assign(state_->x.size(), 0);
  for (std::size_t i = 0; i < state_->beams; ++i) {
    const double angle = from + (to - from) * static_cast<double>(i) / static_cast<double>(state_->beams - 1);
    state_->x[i] = static_cast<float>(std::cos(angle)), state_->y[i] = static_cast<float>(std::sin(angle));
  }
}

void BareRays::trace(const Eigen::Isometry3d& sensor, std::span<float> ranges) const {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | 0x8040U);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(64) RTCRayHit16 packet;
  alignas(64) std::array<int, 16> valid;
  const Eigen::Vector3f o = sensor.translation().cast<float>(), u = sensor.linear().col(0).cast<float>(),
                        v = sensor.linear().col(1).cast<float>();
  for (std::size_t i = 0; i < 16; ++i) {
    packet.ray.org_x[i] = o.x(), packet.ray.org_y[i] = o.y(), packet.ray.org_z[i] = o.z();
    packet.ray.tnear[i] = packet.ray.time[i] = 0;
    packet.ray.mask[i] = 0xffffffffU;
    packet.ray.flags[i] = 0;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    valid[i] = -1;
  }
  for (std::size_t first = 0; first < state_->beams; first += 16) {
    const std::size_t count = std::min<std::size_t>(16, state_->beams - first);
    for (std::size_t i = count; i < 16; ++i) valid[i] = 0;
    for (std::size_t i = 0; i < 16; ++i) {
      const float x = state_->x[first + i], y = state_->y[first + i];
      packet.ray.dir_x[i] = u.x() * x + v.x() * y;
      packet.ray.dir_y[i] = u.y() * x + v.y() * y;
      packet.ray.dir_z[i] = u.z() * x + v.z() * y;
      packet.ray.tfar[i] = state_->far;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    }
    rtcIntersect16(valid.data(), state_->scene, &context, &packet);
    for (std::size_t i = 0; i < count; ++i)
      ranges[first + i] = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID ? packet.ray.tfar[i] : std::numeric_limits<float>::infinity();
  }
  _mm_setcsr(before);
}

}  // namespace sim::bench

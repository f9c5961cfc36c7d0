#include "rays/ray_scene.h"

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <spdlog/fmt/fmt.h>
#include <xmmintrin.h>

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <mutex>

#include "base/log.h"

namespace sim {
namespace {

constexpr float none = std::numeric_limits<float>::infinity();
constexpr int refits_per_build = 64;

// Embree wants denormals off while it traces; the rest of the program keeps them.
class FlushDenormals {
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040U); }
  ~FlushDenormals() { _mm_setcsr(before_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned before_;
};

// Embree takes a direction below 1e-18 for a positive one, but its coherent packets sort rays by the sign the direction had: a component
// of -2e-19, as of a robot that stands almost exactly along an axis, makes whole packets miss. So what is next to nothing becomes nothing;
// 1e-8 is a third of a micrometre at 30 m, and products of two such numbers stay above Embree's limit.
float without_dust(float v) { return std::abs(v) < 1e-8F ? 0.0F : v; }

void on_error(void*, RTCError, const char* text) { base::log(base::Level::error, "rays", "embree: {}", text); }

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct GeometryRelease {
  void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using Scene = std::unique_ptr<RTCSceneTy, SceneRelease>;
using Geometry = std::unique_ptr<RTCGeometryTy, GeometryRelease>;

struct Look {
  float retro = 0;
  std::uint32_t color = 0;
};

struct Plane {
  RayBodyId body = 0;
  Eigen::Vector3d normal;
  double distance = 0;  // normal . point
  Look look;
};

struct ShapeScene {
  Scene scene;
  std::vector<Look> looks;  // by geometry id
};

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

// What tells shapes that look the same from those that do not.
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

}  // namespace

// --- beams

Beams::Beams(std::span<const Eigen::Vector3f> directions, float near, float far) : size_(directions.size()), far_(far) {
  const std::size_t padded = (size_ + 15) / 16 * 16;
  x_.assign(padded, 1);
  y_.assign(padded, 0);
  z_.assign(padded, 0);
  near_.assign(padded, near);
  for (std::size_t i = 0; i < size_; ++i) x_[i] = directions[i].x(), y_[i] = directions[i].y(), z_[i] = directions[i].z();
}

Beams Beams::fan(int beams, double from, double to, int layers, double lowest, double highest, float near, float far) {
  std::vector<Eigen::Vector3f> directions;
  directions.reserve(static_cast<std::size_t>(beams) * static_cast<std::size_t>(layers));
  for (int layer = 0; layer < layers; ++layer) {
    const double up = layers > 1 ? lowest + (highest - lowest) * layer / (layers - 1) : lowest;
    for (int beam = 0; beam < beams; ++beam) {
      const double angle = beams > 1 ? from + (to - from) * beam / (beams - 1) : (from + to) / 2;
      directions.emplace_back(static_cast<float>(std::cos(up) * std::cos(angle)), static_cast<float>(std::cos(up) * std::sin(angle)),
                              static_cast<float>(std::sin(up)));
    }
  }
  return Beams(directions, near, far);
}

// --- the scene

class RayScene::Impl {
 public:
  explicit Impl(TriangleCache& cache) : cache_(cache) {
    device_.reset(rtcNewDevice("threads=1,start_threads=0"));
    rtcSetDeviceErrorFunction(device_.get(), on_error, nullptr);
    top_.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(top_.get(), RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST);
    statics_ = make_scene(RTC_BUILD_QUALITY_MEDIUM);
  }

  struct Body {
    bool is_used = false, is_moving = false;
    std::shared_ptr<ShapeScene> shapes;
    Geometry instance;  // moving: in the top scene
    unsigned instance_id = RTC_INVALID_GEOMETRY_ID;
    std::vector<unsigned> geometry_ids;  // static: in the static scene
    std::string key;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  };

  ShapeScene make_scene(RTCBuildQuality quality) const {
    ShapeScene made;
    made.scene.reset(rtcNewScene(device_.get()));
    rtcSetSceneFlags(made.scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(made.scene.get(), quality);
    return made;
  }

  Geometry make(const RayShape& shape, const Eigen::Isometry3d& pose, std::vector<std::string>& notes) {
    const GeometryDef& g = *shape.geometry;
    if (const auto* b = std::get_if<BoxShape>(&g)) return box(device_.get(), b->size, pose);
    if (const auto* s = std::get_if<SphereShape>(&g)) return sphere(device_.get(), s->radius, pose);
    if (const auto* c = std::get_if<CylinderShape>(&g))
      return rod(device_.get(), RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE, c->radius, c->length, pose);
    if (const auto* p = std::get_if<CapsuleShape>(&g))
      return rod(device_.get(), RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE, p->radius, p->length, pose);
    // Fine enough for lidars: a few tenths of a millimetre on an ellipsoid of a metre.
    if (const auto* e = std::get_if<EllipsoidShape>(&g)) {
      const TriangleMesh mesh = ellipsoid_triangles(e->radii, 96, 192);
      return triangles(device_.get(), mesh.vertices, mesh.triangles, pose);
    }
    const auto mesh = cache_.triangles(g);
    if (!mesh) {
      notes.push_back(mesh.error().message + "; rays do not see it");
      return nullptr;
    }
    return triangles(device_.get(), (*mesh)->vertices, (*mesh)->triangles, pose);
  }

  // Ids of the geometries added.
  std::vector<unsigned> fill(ShapeScene& scene, std::span<const RayShape> shapes, const Eigen::Isometry3d& pose, RayBodyId body,
                             std::vector<std::string>& notes) {
    std::vector<unsigned> ids;
    for (const auto& shape : shapes) {
      const Eigen::Isometry3d place = pose * shape.pose;
      if (const auto* plane = std::get_if<PlaneShape>(shape.geometry)) {
        const Eigen::Vector3d normal = (place.linear() * plane->normal).normalized();
        planes_.push_back({body, normal, normal.dot(place.translation()), {shape.retro, shape.color}});
        continue;
      }
      const Geometry geometry = make(shape, place, notes);
      if (!geometry) continue;
      rtcCommitGeometry(geometry.get());
      const unsigned id = rtcAttachGeometry(scene.scene.get(), geometry.get());
      if (scene.looks.size() <= id) scene.looks.resize(id + 1);
      scene.looks[id] = {shape.retro, shape.color};
      ids.push_back(id);
    }
    return ids;
  }

  RayBodyId add(bool is_moving, std::span<const RayShape> shapes, const Eigen::Isometry3d& pose, std::vector<std::string>& notes) {
    RayBodyId id = 0;
    while (id < bodies_.size() && bodies_[id].is_used) ++id;
    if (id == bodies_.size()) bodies_.emplace_back();
    Body& body = bodies_[id];
    body = Body();
    body.is_used = true;
    body.is_moving = is_moving;
    body.pose = pose;
    if (is_moving) {
      add_instance(body, id, shapes, notes);
    } else {
      body.geometry_ids = fill(statics_, shapes, pose, id, notes);
      statics_changed_ = true;
    }
    changed_ = needs_build_ = true;
    return id;
  }

  void add_instance(Body& body, RayBodyId id, std::span<const RayShape> shapes, std::vector<std::string>& notes) {
    body.key = key_of(shapes);
    auto& shared = shared_[body.key];
    body.shapes = shared.lock();
    if (!body.shapes) {
      body.shapes = std::make_shared<ShapeScene>(make_scene(RTC_BUILD_QUALITY_MEDIUM));
      fill(*body.shapes, shapes, Eigen::Isometry3d::Identity(), id, notes);
      rtcCommitScene(body.shapes->scene.get());
      shared = body.shapes;
    }
    if (body.shapes->looks.empty()) return;  // nothing to see
    body.instance.reset(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
    rtcSetGeometryInstancedScene(body.instance.get(), body.shapes->scene.get());
    rtcSetGeometryTimeStepCount(body.instance.get(), 1);
    place(body);
    body.instance_id = rtcAttachGeometry(top_.get(), body.instance.get());
    if (instances_.size() <= body.instance_id) instances_.resize(body.instance_id + 1, nullptr);
    instances_[body.instance_id] = body.shapes.get();
  }

  void place(Body& body) const {
    std::array<float, 12> m;
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) {
        const auto value = static_cast<float>(body.pose.matrix()(row, column));
        m[static_cast<std::size_t>(column * 3 + row)] = column < 3 ? without_dust(value) : value;
      }
    }
    rtcSetGeometryTransform(body.instance.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, m.data());
    rtcCommitGeometry(body.instance.get());
  }

  void commit() {
    if (statics_changed_) {
      rtcCommitScene(statics_.scene.get());
      if (!static_instance_) {
        static_instance_.reset(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(static_instance_.get(), statics_.scene.get());
        static_id_ = rtcAttachGeometry(top_.get(), static_instance_.get());
        if (instances_.size() <= static_id_) instances_.resize(static_id_ + 1, nullptr);
        instances_[static_id_] = &statics_;
      }
      rtcCommitGeometry(static_instance_.get());
      statics_changed_ = false;
    }
    if (!changed_) return;
    // Refitting keeps the tree of an earlier moment, which gets worse as bodies travel.
    const bool is_full = needs_build_ || ++refits_ >= refits_per_build;
    if (is_full) refits_ = 0, ++full_builds_;
    rtcSetSceneBuildQuality(top_.get(), RTC_BUILD_QUALITY_LOW);
    rtcCommitScene(top_.get());
    changed_ = needs_build_ = false;
  }

  Look look_of(unsigned instance, unsigned geometry) const {
    if (instance >= instances_.size() || instances_[instance] == nullptr || geometry >= instances_[instance]->looks.size()) return {};
    return instances_[instance]->looks[geometry];
  }

  TriangleCache& cache_;
  Device device_;
  Scene top_;
  ShapeScene statics_;
  Geometry static_instance_;
  unsigned static_id_ = RTC_INVALID_GEOMETRY_ID;
  std::vector<Body> bodies_;
  std::map<std::string, std::weak_ptr<ShapeScene>> shared_;
  std::vector<const ShapeScene*> instances_;  // by geometry id in the top scene
  std::vector<Plane> planes_;
  bool changed_ = true, needs_build_ = true, statics_changed_ = true;
  int refits_ = 0;
  std::uint64_t full_builds_ = 0;
};

RayScene::RayScene(TriangleCache& triangles) : impl_(std::make_unique<Impl>(triangles)) { commit(); }
RayScene::~RayScene() = default;

RayBodyId RayScene::add_static(std::span<const RayShape> shapes, const Eigen::Isometry3d& pose, std::vector<std::string>& notes) {
  return impl_->add(false, shapes, pose, notes);
}

RayBodyId RayScene::add_moving(std::span<const RayShape> shapes, const Eigen::Isometry3d& pose, std::vector<std::string>& notes) {
  return impl_->add(true, shapes, pose, notes);
}

void RayScene::remove(RayBodyId id) {
  auto& body = impl_->bodies_[id];
  if (body.instance) {
    rtcDetachGeometry(impl_->top_.get(), body.instance_id);
    impl_->instances_[body.instance_id] = nullptr;
  }
  for (const auto geometry : body.geometry_ids) rtcDetachGeometry(impl_->statics_.scene.get(), geometry);
  impl_->statics_changed_ = impl_->statics_changed_ || !body.geometry_ids.empty();
  std::erase_if(impl_->planes_, [&](const Plane& plane) { return plane.body == id; });
  body = Impl::Body();
  impl_->changed_ = impl_->needs_build_ = true;
}

void RayScene::set_pose(RayBodyId id, const Eigen::Isometry3d& pose) {
  auto& body = impl_->bodies_[id];
  if (!body.instance || (body.pose.matrix().array() == pose.matrix().array()).all()) return;
  body.pose = pose;
  impl_->place(body);
  impl_->changed_ = true;
}

void RayScene::commit() { impl_->commit(); }
std::uint64_t RayScene::full_builds() const { return impl_->full_builds_; }

void RayScene::trace(const Beams& beams, const Eigen::Isometry3d& sensor, std::span<float> ranges, std::span<float> retros) const {
  const FlushDenormals flush;
  const Eigen::Matrix3f r = sensor.linear().cast<float>();
  const Eigen::Vector3f origin = sensor.translation().cast<float>();
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  alignas(64) RTCRayHit16 packet;
  alignas(64) std::array<int, 16> valid;
  alignas(64) std::array<float, 16> plane_retro;
  for (std::size_t first = 0; first < beams.size_; first += 16) {
    const float *x = &beams.x_[first], *y = &beams.y_[first], *z = &beams.z_[first], *near = &beams.near_[first];
    const auto count = std::min<std::size_t>(16, beams.size_ - first);
    for (std::size_t i = 0; i < 16; ++i) {
      packet.ray.dir_x[i] = without_dust(r(0, 0) * x[i] + r(0, 1) * y[i] + r(0, 2) * z[i]);
      packet.ray.dir_y[i] = without_dust(r(1, 0) * x[i] + r(1, 1) * y[i] + r(1, 2) * z[i]);
      packet.ray.dir_z[i] = without_dust(r(2, 0) * x[i] + r(2, 1) * y[i] + r(2, 2) * z[i]);
      packet.ray.org_x[i] = origin.x();
      packet.ray.org_y[i] = origin.y();
      packet.ray.org_z[i] = origin.z();
      packet.ray.tnear[i] = near[i];
      packet.ray.tfar[i] = beams.far_;
      packet.ray.time[i] = 0;
      packet.ray.mask[i] = 0xffffffffU;
      packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      valid[i] = i < count ? -1 : 0;
      plane_retro[i] = -1;
    }
    // Planes first: what lies behind them need not be looked for.
    for (const auto& plane : impl_->planes_) {
      const Eigen::Vector3f n = plane.normal.cast<float>();
      const auto height = static_cast<float>(plane.distance - plane.normal.dot(sensor.translation()));
      for (std::size_t i = 0; i < 16; ++i) {
        const float t = height / (n.x() * packet.ray.dir_x[i] + n.y() * packet.ray.dir_y[i] + n.z() * packet.ray.dir_z[i]);
        const bool is_nearer = t >= packet.ray.tnear[i] && t < packet.ray.tfar[i];
        packet.ray.tfar[i] = is_nearer ? t : packet.ray.tfar[i];
        plane_retro[i] = is_nearer ? plane.look.retro : plane_retro[i];
      }
    }
    rtcIntersect16(valid.data(), impl_->top_.get(), &context, &packet);
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      ranges[first + i] = is_hit || plane_retro[i] >= 0 ? packet.ray.tfar[i] : none;
    }
    if (retros.empty()) continue;
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_hit = packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID;
      retros[first + i] = is_hit ? impl_->look_of(packet.hit.instID[0][i], packet.hit.geomID[i]).retro : std::max(plane_retro[i], 0.0F);
    }
  }
}

RayHit RayScene::trace_one(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float near, float far) const {
  const FlushDenormals flush;
  RayHit result;
  result.range = none;
  RTCRayHit ray{};
  const Eigen::Vector3f o = origin.cast<float>(), d = direction.cast<float>().unaryExpr(&without_dust);
  ray.ray.org_x = o.x(), ray.ray.org_y = o.y(), ray.ray.org_z = o.z();
  ray.ray.dir_x = d.x(), ray.ray.dir_y = d.y(), ray.ray.dir_z = d.z();
  ray.ray.tnear = near;
  ray.ray.tfar = far;
  ray.ray.mask = 0xffffffffU;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  for (const auto& plane : impl_->planes_) {
    const double t = (plane.distance - plane.normal.dot(origin)) / plane.normal.dot(direction);
    if (!(t >= near && t < ray.ray.tfar)) continue;
    ray.ray.tfar = result.range = static_cast<float>(t);
    result.normal = plane.normal.cast<float>();
    result.retro = plane.look.retro;
    result.color = plane.look.color;
  }
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->top_.get(), &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return result;
  const Look look = impl_->look_of(ray.hit.instID[0], ray.hit.geomID);
  result.range = ray.ray.tfar;
  result.retro = look.retro;
  result.color = look.color;
  result.normal = Eigen::Vector3f(ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z);  // in the instance's frame
  for (const auto& body : impl_->bodies_) {
    if (body.instance && body.instance_id == ray.hit.instID[0]) result.normal = body.pose.linear().cast<float>() * result.normal;
  }
  result.normal.normalize();
  return result;
}

void RayScene::look_out_of(std::span<const RayShape> shapes, const Eigen::Isometry3d& sensor, Beams& beams) {
  const FlushDenormals flush;
  std::vector<std::string> ignored;
  for (const auto& shape : shapes) {
    if (std::holds_alternative<PlaneShape>(*shape.geometry) || std::holds_alternative<HeightmapShape>(*shape.geometry)) continue;
    const Geometry geometry = impl_->make(shape, shape.pose, ignored);
    if (!geometry) continue;
    rtcCommitGeometry(geometry.get());
    const ShapeScene alone = impl_->make_scene(RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometry(alone.scene.get(), geometry.get());
    rtcCommitScene(alone.scene.get());
    for (std::size_t i = 0; i < beams.size(); ++i) {
      const Eigen::Vector3f o = sensor.translation().cast<float>(), d = sensor.linear().cast<float>() * beams.direction(i);
      RTCRayHit ray{};
      ray.ray.org_x = o.x(), ray.ray.org_y = o.y(), ray.ray.org_z = o.z();
      ray.ray.dir_x = d.x(), ray.ray.dir_y = d.y(), ray.ray.dir_z = d.z();
      ray.ray.tfar = beams.far();
      ray.ray.mask = 0xffffffffU;
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      rtcIntersect1(alone.scene.get(), &context, &ray);
      if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
      const bool goes_out = ray.hit.Ng_x * d.x() + ray.hit.Ng_y * d.y() + ray.hit.Ng_z * d.z() > 0;
      if (goes_out) beams.set_near(i, std::max(beams.near(i), ray.ray.tfar * 1.0001F + 1e-4F));
    }
  }
}

}  // namespace sim

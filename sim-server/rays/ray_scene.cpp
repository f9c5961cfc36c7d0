#include "rays/ray_scene.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "base/guarded.h"
#include "base/log.h"
#include "base/text.h"
#include "rays/body_grid.h"
#include "rays/embree.h"
#include "rays/shape_scene.h"

namespace sim {
namespace {

using embree::FlushDenormals;
using embree::without_dust;

constexpr float none = std::numeric_limits<float>::infinity();
// Up to this number of moving bodies in reach of a sensor, rays are intersected with each body in its own frame: no tree has to be built
// for a scan, and most packets miss most bodies. With more, a tree over all bodies is built once for all scans of one time.
constexpr std::size_t few_bodies = 32;

void on_error(void*, RTCError, const char* text) { base::log(base::Level::error, "rays", "embree: {}", text); }

struct Plane {
  RayBodyId body = 0;
  Eigen::Vector3d normal;
  double distance = 0;  // normal . point
  Look look;
};

// 16 rays as Embree takes them; what no packet changes is filled in once.
struct Packet {
  alignas(64) RTCRayHit16 rays;

  explicit Packet(const Eigen::Vector3f& origin) {
    for (std::size_t i = 0; i < 16; ++i) {
      rays.ray.org_x[i] = origin.x();
      rays.ray.org_y[i] = origin.y();
      rays.ray.org_z[i] = origin.z();
      rays.ray.time[i] = 0;
      rays.ray.mask[i] = 0xffffffffU;
      rays.ray.id[i] = rays.ray.flags[i] = 0;
    }
  }
  void turn(const Eigen::Matrix3f& r, const float* x, const float* y, const float* z) {
    const float xx = r(0, 0), xy = r(0, 1), xz = r(0, 2), yx = r(1, 0), yy = r(1, 1), yz = r(1, 2), zx = r(2, 0), zy = r(2, 1),
                zz = r(2, 2);
    for (std::size_t i = 0; i < 16; ++i) {
      rays.ray.dir_x[i] = without_dust(xx * x[i] + xy * y[i] + xz * z[i]);
      rays.ray.dir_y[i] = without_dust(yx * x[i] + yy * y[i] + yz * z[i]);
      rays.ray.dir_z[i] = without_dust(zx * x[i] + zy * y[i] + zz * z[i]);
    }
  }
  void intersect(RTCScene scene, const int* valid, RTCIntersectContext& context) {
    for (std::size_t i = 0; i < 16; ++i) rays.hit.geomID[i] = rays.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect16(valid, scene, &context, &rays);
  }
  bool is_hit(std::size_t i) const { return rays.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID; }
};

RTCRayHit single_ray(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float near, float far) {
  RTCRayHit ray{};
  ray.ray.org_x = origin.x(), ray.ray.org_y = origin.y(), ray.ray.org_z = origin.z();
  ray.ray.dir_x = without_dust(direction.x()), ray.ray.dir_y = without_dust(direction.y()), ray.ray.dir_z = without_dust(direction.z());
  ray.ray.tnear = near;
  ray.ray.tfar = far;
  ray.ray.mask = 0xffffffffU;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

bool hits(RTCScene scene, RTCRayHit& ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
  return ray.hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

Eigen::Vector3f normal_of(const RTCRayHit& ray) { return {ray.hit.Ng_x, ray.hit.Ng_y, ray.hit.Ng_z}; }

}  // namespace

class RayScene::Impl {
  // Embree's versions for AVX2 and AVX-512 are more than twice as fast as those up to AVX, and give distances that differ in their last
  // bits. Who wants the same on every processor says RTMSIM_RAYS_ISA=avx.
  static std::string device_settings() {
    constexpr std::array known = {std::string_view("sse2"), std::string_view("sse4.2"), std::string_view("avx"), std::string_view("avx2"),
                                  std::string_view("avx512")};
    std::string settings = "threads=1,start_threads=0";
    const char* most = std::getenv("RTMSIM_RAYS_ISA");
    if (most == nullptr || *most == '\0') return settings;
    if (std::ranges::find(known, std::string_view(most)) != known.end()) return settings + ",max_isa=" + most;
    base::log(base::Level::warn, "rays", "RTMSIM_RAYS_ISA must be sse2, sse4.2, avx, avx2 or avx512, got {}", base::in_quotes(most));
    return settings;
  }

 public:
  explicit Impl(TriangleCache& cache)
      : cache_(cache), device_(embree::made(rtcNewDevice(device_settings().c_str()))), statics_(device_.get(), RTC_BUILD_QUALITY_HIGH) {
    rtcSetDeviceErrorFunction(device_.get(), on_error, nullptr);
    crowd_.reset(embree::made(rtcNewScene(device_.get())));
    rtcSetSceneFlags(crowd_.get(), RTC_SCENE_FLAG_DYNAMIC | RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(crowd_.get(), RTC_BUILD_QUALITY_LOW);
  }

  struct Body {
    bool is_used = false;
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    std::vector<unsigned> geometry_ids;  // static: in the static scene
    // moving:
    std::shared_ptr<ShapeScene> shapes;
    Eigen::Vector3f middle{0, 0, 0}, half{0, 0, 0};  // of its box, in its frame
    embree::Geometry instance;                       // in the crowd
    unsigned instance_id = RTC_INVALID_GEOMETRY_ID;
  };
  // A moving body seen from a sensor.
  struct Nearby {
    const Body* body = nullptr;
    Eigen::Matrix3f turn;        // from the sensor's frame to the body's
    Eigen::Vector3f origin;      // the sensor in the body's frame
    Eigen::Vector3f toward;      // unit, to its middle in the sensor's frame
    float nearest = 0;           // of its sphere; negative: the sensor is inside
    float cosine = 1, sine = 0;  // of half the angle that the sphere covers

    // From a margin on: the sphere is beside the cone.
    bool is_beside(const Beams::Cone& cone) const {
      constexpr float margin = 1e-5F;
      const float both = cosine * cone.cosine - sine * cone.sine;  // of the sum of the two angles, which may be more than half a turn
      return cosine + cone.cosine > 0 && cone.axis.dot(toward) < both - margin;
    }
  };
  struct NearbyPlane {
    Eigen::Vector3f normal;  // in the world
    float height = 0;        // of the plane over the sensor, along the normal
    float retro = 0;
  };

  // Ids of the geometries added.
  std::vector<unsigned> fill(ShapeScene& scene, std::span<const RayShape> shapes, const Eigen::Isometry3d& pose, RayBodyId body,
                             std::vector<std::string>& notes) {
    std::vector<unsigned> ids;
    for (const auto& shape : shapes) {
      const Eigen::Isometry3d place = pose * shape.pose;
      const Look look{shape.retro, shape.color};
      has_retro_ = has_retro_ || shape.retro != 0;
      if (const auto* plane = std::get_if<PlaneShape>(shape.geometry)) {
        const Eigen::Vector3d normal = (place.linear() * plane->normal).normalized();
        planes_.push_back({body, normal, normal.dot(place.translation()), look});
        continue;
      }
      const auto geometry = make_geometry(device_.get(), *shape.geometry, place, cache_, notes);
      if (geometry) ids.push_back(scene.add(geometry, *shape.geometry, look));
    }
    return ids;
  }

  RayBodyId add(bool is_moving, std::span<const RayShape> shapes, const Eigen::Isometry3d& pose, std::vector<std::string>& notes) {
    RayBodyId id = first_free_;
    while (id < bodies_.size() && bodies_[id].is_used) ++id;
    first_free_ = id + 1;
    if (id == bodies_.size()) bodies_.emplace_back();
    Body& body = bodies_[id];
    body = Body();
    body.is_used = true;
    body.pose = pose;
    if (is_moving) {
      add_moving(body, id, shapes, notes);
    } else {
      body.geometry_ids = fill(statics_, shapes, pose, id, notes);
      statics_changed_ = true;
    }
    return id;
  }

  void add_moving(Body& body, RayBodyId id, std::span<const RayShape> shapes, std::vector<std::string>& notes) {
    auto& shared = shared_[key_of(shapes)];
    body.shapes = shared.lock();
    if (!body.shapes) {
      body.shapes = std::make_shared<ShapeScene>(device_.get(), RTC_BUILD_QUALITY_MEDIUM);
      fill(*body.shapes, shapes, Eigen::Isometry3d::Identity(), id, notes);
      rtcCommitScene(body.shapes->scene.get());
      shared = body.shapes;
    }
    if (body.shapes->looks.empty()) return;  // nothing to see
    RTCBounds bounds;
    rtcGetSceneBounds(body.shapes->scene.get(), &bounds);
    const Eigen::Vector3f low(bounds.lower_x, bounds.lower_y, bounds.lower_z), high(bounds.upper_x, bounds.upper_y, bounds.upper_z);
    body.middle = (low + high) / 2;
    body.half = (high - low) / 2 + Eigen::Vector3f::Constant(1e-4F);
    body.instance.reset(embree::made(rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_INSTANCE)));
    rtcSetGeometryInstancedScene(body.instance.get(), body.shapes->scene.get());
    rtcSetGeometryTimeStepCount(body.instance.get(), 1);
    body.instance_id = rtcAttachGeometry(crowd_.get(), body.instance.get());
    moving_.push_back(id);
    crowd_changed_ = true;
  }

  void place_in_crowd(const Body& body) const {
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
      // What is spawned or moved later must not stop the run for as long.
      rtcSetSceneBuildQuality(statics_.scene.get(), RTC_BUILD_QUALITY_MEDIUM);
      statics_changed_ = false;
    }
    if (!crowd_changed_ || !is_crowded()) return;
    std::vector<BodyGrid::Entry> entries;
    for (const auto id : moving_) {
      const Body& body = bodies_[id];
      const Eigen::Vector3d middle = body.pose * body.middle.cast<double>();
      entries.push_back({id, middle.x(), middle.y(), body.half.norm()});
    }
    grid_.build(entries);
    crowd_changed_ = false;
    is_crowd_built_.store(false, std::memory_order_relaxed);
  }

  // Called by each thread that needs it; the first one builds. Embree can't refit a scene of instances, so it is built again each time.
  void build_crowd() {
    if (is_crowd_built_.load(std::memory_order_acquire)) return;  // pairs with the store below
    const auto mine = building_.take();
    if (is_crowd_built_.load(std::memory_order_relaxed)) return;
    body_of_instance_.clear();
    for (const auto id : moving_) {
      const Body& body = bodies_[id];
      place_in_crowd(body);
      if (body_of_instance_.size() <= body.instance_id) body_of_instance_.resize(body.instance_id + 1, nullptr);
      body_of_instance_[body.instance_id] = &body;
    }
    rtcCommitScene(crowd_.get());
    is_crowd_built_.store(true, std::memory_order_release);
  }

  bool is_crowded() const { return moving_.size() > few_bodies; }
  const Body* body_of(unsigned instance) const { return instance < body_of_instance_.size() ? body_of_instance_[instance] : nullptr; }

  std::vector<NearbyPlane> planes_in_reach(const Beams& beams, const Eigen::Isometry3d& sensor) const;
  // Nothing when no beam can reach it.
  std::optional<Nearby> look_at(const Body& body, const Beams& beams, const Eigen::Isometry3d& sensor) const;
  std::vector<Nearby> nearby(const Beams& beams, const Eigen::Isometry3d& sensor) const;

  TriangleCache& cache_;
  embree::Device device_;
  ShapeScene statics_;
  embree::Scene crowd_;  // instances of all moving bodies
  std::vector<Body> bodies_;
  RayBodyId first_free_ = 0;       // all ids below are used
  std::vector<RayBodyId> moving_;  // those with something to see
  std::map<std::string, std::weak_ptr<ShapeScene>> shared_;
  std::vector<const Body*> body_of_instance_;
  std::vector<Plane> planes_;
  BodyGrid grid_;  // of all moving bodies, when there are more than a few
  base::Turn<> building_;
  std::atomic<bool> is_crowd_built_{false};
  bool statics_changed_ = true, crowd_changed_ = true, has_retro_ = false;
};

std::optional<RayScene::Impl::Nearby> RayScene::Impl::look_at(const Body& body, const Beams& beams, const Eigen::Isometry3d& sensor) const {
  Nearby seen;
  const Eigen::Matrix3d turn = body.pose.linear().transpose() * sensor.linear();
  seen.body = &body;
  seen.turn = turn.cast<float>();
  seen.origin = (body.pose.linear().transpose() * (sensor.translation() - body.pose.translation())).cast<float>();
  const Eigen::Vector3f middle = seen.turn.transpose() * (body.middle - seen.origin), half = seen.turn.cwiseAbs().transpose() * body.half;
  // The box around all that the beams can reach against the box around the body, both along the axes of the sensor.
  const Eigen::Vector3f low = (beams.far_ * beams.low_).cwiseMin(0), high = (beams.far_ * beams.high_).cwiseMax(0);
  if (((middle + half).array() < low.array()).any() || ((middle - half).array() > high.array()).any()) return {};
  const float distance = middle.norm(), radius = body.half.norm();
  seen.nearest = distance - radius;
  if (seen.nearest > beams.far_) return {};
  seen.toward = middle / std::max(distance, 1e-6F);
  if (seen.nearest > 0) {
    seen.sine = radius / distance;
    seen.cosine = std::sqrt(1 - seen.sine * seen.sine);
  }
  return seen;
}

std::vector<RayScene::Impl::NearbyPlane> RayScene::Impl::planes_in_reach(const Beams& beams, const Eigen::Isometry3d& sensor) const {
  std::vector<NearbyPlane> all;
  for (const auto& plane : planes_) {
    const double height = plane.distance - plane.normal.dot(sensor.translation());
    const Eigen::Vector3f normal = (sensor.linear().transpose() * plane.normal).cast<float>();
    // How fast the beam comes nearer that comes nearer fastest, at most: the corner of the box of directions.
    const Eigen::Vector3f best = height > 0 ? normal.cwiseProduct(beams.low_).cwiseMax(normal.cwiseProduct(beams.high_)).eval()
                                            : (-normal).cwiseProduct(beams.low_).cwiseMax((-normal).cwiseProduct(beams.high_)).eval();
    if (static_cast<double>(best.sum()) * beams.far_ < std::abs(height) * 0.999) continue;
    all.push_back({plane.normal.cast<float>(), static_cast<float>(height), plane.look.retro});
  }
  return all;
}

std::vector<RayScene::Impl::Nearby> RayScene::Impl::nearby(const Beams& beams, const Eigen::Isometry3d& sensor) const {
  std::vector<Nearby> all;
  const auto look = [&](RayBodyId id) {
    if (auto seen = look_at(bodies_[id], beams, sensor)) all.push_back(*seen);
  };
  if (is_crowded()) {
    std::vector<RayBodyId> ids;
    grid_.find(sensor.translation().x(), sensor.translation().y(), 1.001 * static_cast<double>(beams.far_), ids);
    std::ranges::for_each(ids, look);
  } else {
    std::ranges::for_each(moving_, look);
  }
  return all;
}

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
    rtcDetachGeometry(impl_->crowd_.get(), body.instance_id);
    std::erase(impl_->moving_, id);
    impl_->crowd_changed_ = true;
  }
  for (const auto geometry : body.geometry_ids) rtcDetachGeometry(impl_->statics_.scene.get(), geometry);
  impl_->statics_changed_ = impl_->statics_changed_ || !body.geometry_ids.empty();
  std::erase_if(impl_->planes_, [&](const Plane& plane) { return plane.body == id; });
  body = Impl::Body();
  impl_->first_free_ = std::min(impl_->first_free_, id);
}

void RayScene::set_pose(RayBodyId id, const Eigen::Isometry3d& pose) {
  auto& body = impl_->bodies_[id];
  if (!body.instance || (body.pose.matrix().array() == pose.matrix().array()).all()) return;
  body.pose = pose;
  impl_->crowd_changed_ = true;
}

void RayScene::commit() { impl_->commit(); }

void RayScene::trace(const Beams& beams, const Eigen::Isometry3d& sensor, std::span<float> ranges, std::span<float> retros) const {
  const FlushDenormals flush;
  const Impl& scene = *impl_;
  const Eigen::Matrix3f r = sensor.linear().cast<float>();
  auto bodies = scene.nearby(beams, sensor);
  const bool meets_crowd = bodies.size() > few_bodies;
  if (meets_crowd) {
    impl_->build_crowd();
    bodies.clear();
  }
  const auto planes = scene.planes_in_reach(beams, sensor);
  const bool wants_retros = !retros.empty() && scene.has_retro_;
  if (!wants_retros) std::fill(retros.begin(), retros.end(), 0.0F);
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  Packet packet(sensor.translation().cast<float>()), in_body(Eigen::Vector3f::Zero());
  RTCRay16& rays = packet.rays.ray;
  alignas(64) std::array<int, 16> valid;
  alignas(64) std::array<float, 16> retro;
  valid.fill(-1);
  for (std::size_t first = 0; first < beams.size_; first += 16) {
    const float *x = &beams.x_[first], *y = &beams.y_[first], *z = &beams.z_[first], *near = &beams.near_[first];
    const auto count = std::min<std::size_t>(16, beams.size_ - first);
    for (std::size_t i = count; i < 16; ++i) valid[i] = 0;
    packet.turn(r, x, y, z);
    for (std::size_t i = 0; i < 16; ++i) rays.tnear[i] = near[i], rays.tfar[i] = beams.far_, retro[i] = -1;
    // Planes first: what lies behind them need not be looked for.
    for (const auto& plane : planes) {
      for (std::size_t i = 0; i < 16; ++i) {
        const float t =
            plane.height / (plane.normal.x() * rays.dir_x[i] + plane.normal.y() * rays.dir_y[i] + plane.normal.z() * rays.dir_z[i]);
        const bool is_nearer = (t >= rays.tnear[i]) & (t < rays.tfar[i]);
        rays.tfar[i] = is_nearer ? t : rays.tfar[i];
        retro[i] = is_nearer ? plane.retro : retro[i];
      }
    }
    packet.intersect(scene.statics_.scene.get(), valid.data(), context);
    if (wants_retros) {
      for (std::size_t i = 0; i < count; ++i) {
        if (packet.is_hit(i)) retro[i] = scene.statics_.look_of(packet.rays.hit.geomID[i]).retro;
      }
    } else {
      for (std::size_t i = 0; i < 16; ++i) retro[i] = packet.is_hit(i) ? 0 : retro[i];
    }
    if (meets_crowd) {
      packet.intersect(scene.crowd_.get(), valid.data(), context);
      for (std::size_t i = 0; i < count; ++i) {
        if (!packet.is_hit(i)) continue;
        const auto* body = scene.body_of(packet.rays.hit.instID[0][i]);
        retro[i] = wants_retros && body != nullptr ? body->shapes->look_of(packet.rays.hit.geomID[i]).retro : 0;
      }
    }
    const Beams::Cone& cone = beams.cones_[first / 16];
    const float farthest = *std::max_element(rays.tfar, rays.tfar + 16);
    for (const auto& seen : bodies) {
      if (seen.nearest > 0 && (seen.nearest > farthest || seen.is_beside(cone))) continue;
      for (std::size_t i = 0; i < 16; ++i) {
        in_body.rays.ray.org_x[i] = seen.origin.x(), in_body.rays.ray.org_y[i] = seen.origin.y(),
        in_body.rays.ray.org_z[i] = seen.origin.z();
        in_body.rays.ray.tnear[i] = rays.tnear[i], in_body.rays.ray.tfar[i] = rays.tfar[i];
      }
      in_body.turn(seen.turn, x, y, z);
      in_body.intersect(seen.body->shapes->scene.get(), valid.data(), context);
      for (std::size_t i = 0; i < count; ++i) {
        if (!in_body.is_hit(i)) continue;
        rays.tfar[i] = in_body.rays.ray.tfar[i];
        retro[i] = wants_retros ? seen.body->shapes->look_of(in_body.rays.hit.geomID[i]).retro : 0;
      }
    }
    for (std::size_t i = 0; i < count; ++i) ranges[first + i] = retro[i] >= 0 ? rays.tfar[i] : none;
    if (!wants_retros) continue;
    for (std::size_t i = 0; i < count; ++i) retros[first + i] = std::max(retro[i], 0.0F);
  }
}

RayHit RayScene::trace_one(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, float near, float far) const {
  const FlushDenormals flush;
  const Impl& scene = *impl_;
  RayHit result;
  result.range = none;
  const auto take = [&](double range, const Look& look, const Eigen::Vector3f& normal) {
    result.range = far = static_cast<float>(range);
    result.normal = normal.normalized();
    result.retro = look.retro;
    result.color = look.color;
  };
  for (const auto& plane : scene.planes_) {
    const double t = (plane.distance - plane.normal.dot(origin)) / plane.normal.dot(direction);
    if (t >= near && t < far) take(t, plane.look, plane.normal.cast<float>());
  }
  const Eigen::Vector3f o = origin.cast<float>(), d = direction.cast<float>();
  RTCRayHit ray = single_ray(o, d, near, far);
  if (hits(scene.statics_.scene.get(), ray)) take(ray.ray.tfar, scene.statics_.look_of(ray.hit.geomID), normal_of(ray));
  if (scene.is_crowded()) {
    impl_->build_crowd();
    ray = single_ray(o, d, near, far);
    const auto* body = hits(scene.crowd_.get(), ray) ? scene.body_of(ray.hit.instID[0]) : nullptr;
    if (body != nullptr) take(ray.ray.tfar, body->shapes->look_of(ray.hit.geomID), body->pose.linear().cast<float>() * normal_of(ray));
    return result;
  }
  for (const auto id : scene.moving_) {
    const auto& body = scene.bodies_[id];
    const Eigen::Vector3f away = (body.pose * body.middle.cast<double>() - origin).cast<float>();
    const float along = away.dot(d), radius = body.half.norm();
    if (along < -radius || along - radius > far || away.squaredNorm() - along * along > radius * radius * 1.001F) continue;
    const Eigen::Matrix3d back = body.pose.linear().transpose();
    ray = single_ray((back * (origin - body.pose.translation())).cast<float>(), (back * direction).cast<float>(), near, far);
    if (hits(body.shapes->scene.get(), ray))
      take(ray.ray.tfar, body.shapes->look_of(ray.hit.geomID), body.pose.linear().cast<float>() * normal_of(ray));
  }
  return result;
}

void RayScene::look_out_of(std::span<const RayShape> shapes, const Eigen::Isometry3d& sensor, Beams& beams) {
  const FlushDenormals flush;
  std::vector<std::string> ignored;
  for (const auto& shape : shapes) {
    if (std::holds_alternative<PlaneShape>(*shape.geometry) || std::holds_alternative<HeightmapShape>(*shape.geometry)) continue;
    const auto geometry = make_geometry(impl_->device_.get(), *shape.geometry, shape.pose, impl_->cache_, ignored);
    if (!geometry) continue;
    ShapeScene alone(impl_->device_.get(), RTC_BUILD_QUALITY_MEDIUM);
    alone.add(geometry, *shape.geometry, {});
    rtcCommitScene(alone.scene.get());
    for (std::size_t i = 0; i < beams.size(); ++i) {
      const Eigen::Vector3f d = sensor.linear().cast<float>() * beams.direction(i);
      RTCRayHit ray = single_ray(sensor.translation().cast<float>(), d, 0, beams.far());
      if (hits(alone.scene.get(), ray) && normal_of(ray).dot(d) > 0)
        beams.set_near(i, std::max(beams.near(i), ray.ray.tfar * 1.0001F + 1e-4F));
    }
  }
}

}  // namespace sim

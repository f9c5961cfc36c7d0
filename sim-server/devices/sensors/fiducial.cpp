// A detector of marks: flat squares that models carry by the plugin Fiducial. It sees a mark when its middle is in range and in the field
// of view, its face is turned to the detector, and 3 of 5 rays to it are free.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "devices/ray_world.h"
#include "devices/sensors/sensor_makers.h"
#include "world/plugin_kind.h"
#include "world/xml_values.h"

namespace sim {
namespace {

constexpr std::uint32_t fiducial_capacity = 128;
constexpr double steepest = 80 * std::numbers::pi / 180;  // [rad] between the mark's normal and the way to the detector
constexpr double thickness = 0.02;                        // [m] of what may be before a mark's face: that which it is painted on
constexpr int free_rays = 3;

struct PaintedMark {
  std::uint32_t id = 0;
  double width = 0.2, height = 0.2;  // [m]
  LinkId link;
  Eigen::Isometry3d in_link = Eigen::Isometry3d::Identity();  // x points out of its face, z is its up
};

// Empty when it names a link that is not there.
std::optional<PaintedMark> mark_of(const ModelDef& model, ModelId id, const PluginDef& plugin) {
  const ParameterNode& p = plugin.parameters;
  PaintedMark mark;
  mark.id = static_cast<std::uint32_t>(std::clamp(p.number_of({"id", "fiducial_id", "fiducial_return"}).value_or(0), 0.0, 4294967295.0));
  const double size = p.number_of({"size"}).value_or(0.2);
  mark.width = p.number_of({"width"}).value_or(size);
  mark.height = p.number_of({"height"}).value_or(size);
  const auto link = link_of(model, plugin.scope, p.text_of({"link", "link_name"}).value_or(model.canonical_link));
  if (!link || model.links.empty()) return std::nullopt;
  mark.link = {id, *link};
  if (const auto n = parse_numbers(p.text_of({"pose"}).value_or("")); n && n->size() == 6) {
    mark.in_link = Eigen::Translation3d((*n)[0], (*n)[1], (*n)[2]) * Eigen::AngleAxisd((*n)[5], Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd((*n)[4], Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd((*n)[3], Eigen::Vector3d::UnitX());
  }
  return mark;
}

// Directions all around, to know where rays leave the casing of the detector.
struct Surround {
  static constexpr int columns = 72, rows = 37;
  static Beams beams(float far) {
    constexpr double pi = std::numbers::pi;
    return Beams::fan(columns, -pi, pi - 2 * pi / columns, rows, -pi / 2, pi / 2, 0, far);
  }
  static std::size_t nearest(const Eigen::Vector3d& direction) {
    constexpr double pi = std::numbers::pi;
    const double yaw = std::atan2(direction.y(), direction.x()), pitch = std::asin(std::clamp(direction.z(), -1.0, 1.0));
    const auto column = static_cast<std::size_t>(std::lround((yaw + pi) / (2 * pi) * columns)) % columns;
    const auto row = static_cast<std::size_t>(std::lround((pitch + pi / 2) / pi * (rows - 1)));
    return row * columns + column;
  }
};

class FiducialDetector final : public Sensor {
 public:
  FiducialDetector(Setup setup, const SensorSite& site)
      : Sensor(std::move(setup)),
        mount_(site.mount),
        def_(std::get<FiducialDef>(site.def.data)),
        surround_(Surround::beams(static_cast<float>(def_.range_max))) {
    world().rays.look_out_of_casing(mount_.link, mount_.pose, surround_);
  }
  bool uses_rays() const override { return true; }

 private:
  void measure(const Moment&) const override {
    const Eigen::Isometry3d pose = mount_.in_world(physics());
    auto& out = sample<shm::FiducialSample>();
    out.pose = to_pose(pose);
    out.count = out.total = 0;
    for (ModelId id = 0; id < physics().model_slots(); ++id) {
      if (!physics().exists(id) || id == mount_.link.model) continue;
      const ModelDef& model = physics().def(id);
      for (const PluginDef& plugin : model.plugins) {
        if (kind_of(plugin) != PluginKind::fiducial) continue;
        if (const auto mark = mark_of(model, id, plugin)) look_at(*mark, model, pose, out);
      }
    }
  }

  void look_at(const PaintedMark& mark, const ModelDef& model, const Eigen::Isometry3d& pose, shm::FiducialSample& out) const {
    const Eigen::Isometry3d seen = pose.inverse() * physics().link_pose(mark.link) * mark.in_link;
    if (!is_in_view(seen) || !is_free(mark, seen, pose)) return;
    ++out.total;
    const auto room = followers<shm::Mark>(0);
    if (out.count >= room.size()) return;
    shm::Mark& one = room[out.count++];
    one = {};
    one.id = mark.id;
    one.pose = to_pose(with_noise(seen));
    one.size[1] = mark.width;
    one.size[2] = mark.height;
    shm::set_text(one.model, model.name);
  }

  bool is_in_view(const Eigen::Isometry3d& seen) const {
    const Eigen::Vector3d& middle = seen.translation();
    const double range = middle.norm();
    if (range < def_.range_min || range > def_.range_max || range < 1e-6) return false;
    if (std::abs(std::atan2(middle.y(), middle.x())) > def_.view_angle / 2) return false;
    return std::acos(std::clamp(-seen.linear().col(0).dot(middle) / range, -1.0, 1.0)) < steepest;
  }

  bool is_free(const PaintedMark& mark, const Eigen::Isometry3d& seen, const Eigen::Isometry3d& pose) const {
    constexpr std::array<std::array<double, 2>, 5> places{{{0, 0}, {-0.25, -0.25}, {-0.25, 0.25}, {0.25, -0.25}, {0.25, 0.25}}};
    int count = 0;
    for (const auto& [across, up] : places) {
      const Eigen::Vector3d point = seen * Eigen::Vector3d(0, across * mark.width, up * mark.height);
      const double range = point.norm();
      const Eigen::Vector3d direction = point / range;
      const float near = surround_.near(Surround::nearest(direction));
      const auto far = static_cast<float>(range - thickness);
      const RayHit hit = near < far ? world().rays.scene().trace_one(pose.translation(), pose.linear() * direction, near, far) : RayHit{};
      if (near >= far || !std::isfinite(hit.range)) ++count;
    }
    return count >= free_rays;
  }

  Eigen::Isometry3d with_noise(Eigen::Isometry3d seen) const {
    for (int i = 0; i < 3; ++i) seen.translation()[i] = noisy(0, seen.translation()[i]);
    for (int i = 0; i < 3; ++i) seen.rotate(Eigen::AngleAxisd(noisy(1, 0), Eigen::Vector3d::Unit(i)));
    return seen;
  }

  Mount mount_;
  FiducialDef def_;
  Beams surround_;
};

}  // namespace

MadeDevice make_fiducial(const SensorSite& site) {
  const auto& def = std::get<FiducialDef>(site.def.data);
  auto info = info_of<shm::FiducialInfo>(site);
  info.capacity = fiducial_capacity;
  info.min_range = def.range_min;
  info.max_range = def.range_max;
  info.view_angle = def.view_angle;
  info.noise[0] = stated_deviation(def.position);
  info.noise[1] = stated_deviation(def.orientation);
  return make_sensor<FiducialDetector>(site, shm::iface_spec(shm::IfaceType::fiducial, site.iface(), info),
                                       {def.position, def.orientation});
}

}  // namespace sim

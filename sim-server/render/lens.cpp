#include "render/lens.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace sim {
namespace {

constexpr double pi = std::numbers::pi;

bool is_flat(const CameraDef& camera) {
  if (camera.lens && camera.lens->type != "gnomonical") return false;
  if (!camera.distortion) return true;
  const auto& d = *camera.distortion;
  return d.k1 == 0 && d.k2 == 0 && d.k3 == 0 && d.p1 == 0 && d.p2 == 0;
}

// Where an ideal point lands on the image of a distorting lens, both as tangents.
Eigen::Vector2d distort(const DistortionDef& d, const Eigen::Vector2d& p) {
  const double r2 = p.squaredNorm();
  const double radial = 1 + r2 * (d.k1 + r2 * (d.k2 + r2 * d.k3));
  return {p.x() * radial + 2 * d.p1 * p.x() * p.y() + d.p2 * (r2 + 2 * p.x() * p.x()),
          p.y() * radial + d.p1 * (r2 + 2 * p.y() * p.y()) + 2 * d.p2 * p.x() * p.y()};
}

// The inverse, by damped fixed-point steps.
Eigen::Vector2d straighten(const DistortionDef& d, const Eigen::Vector2d& seen) {
  Eigen::Vector2d p = seen;
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector2d error = distort(d, p) - seen;
    p -= 0.7 * error;
    if (error.squaredNorm() < 1e-16) break;
    if (!p.allFinite() || p.norm() > 20) return seen;
  }
  return p;
}

// The radius [focal lengths] at which a ray of this angle lands, and back.
struct Projection {
  const LensDef& lens;
  double c1 = 1, c2 = 1, c3 = 0;
  enum class Kind { sine, tangent, straight } kind = Kind::tangent;

  explicit Projection(const LensDef& def) : lens(def) {
    if (def.type == "stereographic") {
      c1 = 2, c2 = 2;
    } else if (def.type == "equidistant") {
      kind = Kind::straight;
    } else if (def.type == "equisolid_angle") {
      c1 = 2, c2 = 2, kind = Kind::sine;
    } else if (def.type == "orthographic") {
      kind = Kind::sine;
    } else if (def.type == "custom") {
      c1 = def.c1 * def.f, c2 = def.c2, c3 = def.c3;
      kind = def.function == "sin" ? Kind::sine : def.function == "id" ? Kind::straight : Kind::tangent;
    }
  }
  double radius(double angle) const {
    const double x = angle / c2 + c3;
    return c1 * (kind == Kind::sine ? std::sin(x) : kind == Kind::straight ? x : std::tan(x));
  }
  double angle(double r) const {
    const double x = r / c1;
    if (kind == Kind::sine && std::abs(x) > 1) return infinite;
    return c2 * ((kind == Kind::sine ? std::asin(x) : kind == Kind::straight ? x : std::atan(x)) - c3);
  }
};

Eigen::Matrix3d turned(const Eigen::Vector3d& forward, const Eigen::Vector3d& up) {
  Eigen::Matrix3d m;
  m.col(0) = forward;
  m.col(1) = up.cross(forward);
  m.col(2) = up;
  return m;
}

}  // namespace

std::optional<Lens> Lens::make(const CameraDef& camera) {
  if (is_flat(camera)) return std::nullopt;
  Lens lens;
  lens.width_ = camera.width;
  lens.height_ = camera.height;
  lens.near_ = camera.near_clip;
  lens.far_ = camera.far_clip;
  lens.sources_.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  if (camera.lens && camera.lens->type != "gnomonical")
    lens.make_wide(camera);
  else
    lens.make_brown(camera);
  return lens;
}

void Lens::make_brown(const CameraDef& camera) {
  const DistortionDef& d = *camera.distortion;
  const double focal = 0.5 * camera.width / std::tan(0.5 * camera.horizontal_fov);
  const Eigen::Vector2d centre(d.center.x() * camera.width, d.center.y() * camera.height);
  std::vector<Eigen::Vector2d> rays;
  Eigen::AlignedBox2d box;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      rays.push_back(straighten(d, (Eigen::Vector2d(x + 0.5, y + 0.5) - centre) / focal));
      box.extend(rays.back());
    }
  }
  // A margin of two pixels for the interpolation; the face has the picture's own resolution.
  const double margin = 2 / focal;
  const Eigen::Vector2d low = (box.min().array() - margin).max(-6.0), high = (box.max().array() + margin).min(6.0);
  const auto pixels = [&](double tangent) { return std::clamp(static_cast<int>(std::ceil(tangent * focal)), 2, 8192); };
  faces_.push_back(
      {Eigen::Matrix3d::Identity(), low.x(), high.x(), -high.y(), -low.y(), pixels(high.x() - low.x()), pixels(high.y() - low.y())});
  for (std::size_t i = 0; i < rays.size(); ++i) assign(i, {1, -rays[i].x(), -rays[i].y()});
}

void Lens::make_wide(const CameraDef& camera) {
  const LensDef& lens = *camera.lens;
  const Projection projection(lens);
  const double edge = projection.radius(0.5 * camera.horizontal_fov);
  // Pixels per unit of radius: the field of view fills the width, or the lens's own focal length counts in half widths.
  const bool fits = lens.scale_to_fov && std::isfinite(edge) && edge > 1e-6;
  const double scale = fits ? 0.5 * camera.width / edge : 0.5 * camera.width;
  const int side = std::clamp(lens.environment_texture_size, 16, 4096);
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  for (const auto& [forward, up] : {std::pair(x, z), std::pair(y, z), std::pair(Eigen::Vector3d(-y), z), std::pair(z, Eigen::Vector3d(-x)),
                                    std::pair(Eigen::Vector3d(-z), x), std::pair(Eigen::Vector3d(-x), z)}) {
    const double reach = 1 + 4.0 / side;  // a little beyond a quarter turn, for the interpolation at the seams
    faces_.push_back({turned(forward, up), -reach, reach, -reach, reach, side, side});
  }
  const double cutoff = std::min(lens.cutoff_angle, pi);
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const Eigen::Vector2d p = (Eigen::Vector2d(column + 0.5, row + 0.5) - 0.5 * Eigen::Vector2d(camera.width, camera.height)) / scale;
      const double angle = projection.angle(p.norm());
      if (!(angle <= cutoff)) continue;
      const Eigen::Vector2d out = p.norm() > 1e-12 ? Eigen::Vector2d(p.normalized() * std::sin(angle)) : Eigen::Vector2d(0, 0);
      assign(static_cast<std::size_t>(row * camera.width + column), {std::cos(angle), -out.x(), -out.y()});
    }
  }
}

void Lens::assign(std::size_t pixel, const Eigen::Vector3d& direction) {
  Source& source = sources_[pixel];
  double best = 0;
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const Face& face = faces_[i];
    const Eigen::Vector3d d = face.turn.transpose() * direction;
    if (d.x() <= best) continue;
    best = d.x();
    const double x = (-d.y() / d.x() - face.left) / (face.right - face.left) * face.width - 0.5;
    const double y = (face.top - d.z() / d.x()) / (face.top - face.bottom) * face.height - 0.5;
    const bool is_inside = x > -0.5 && y > -0.5 && x < face.width - 0.5 && y < face.height - 0.5;
    source = {static_cast<std::int16_t>(is_inside ? static_cast<int>(i) : -1), static_cast<float>(std::clamp(x, 0.0, face.width - 1.001)),
              static_cast<float>(std::clamp(y, 0.0, face.height - 1.001))};
  }
}

std::vector<View> Lens::views(const Eigen::Isometry3d& pose) const {
  std::vector<View> views;
  for (const auto& face : faces_) {
    View view;
    view.pose = pose;
    view.pose.rotate(face.turn);
    view.width = face.width;
    view.height = face.height;
    view.left = face.left;
    view.right = face.right;
    view.bottom = face.bottom;
    view.top = face.top;
    view.near_clip = near_;
    view.far_clip = far_;
    views.push_back(view);
  }
  return views;
}

void Lens::map_rgba(std::size_t view, std::span<const std::uint8_t> source, std::span<std::uint8_t> out) const {
  const auto row = static_cast<std::size_t>(faces_[view].width) * 4;
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& from = sources_[i];
    std::uint8_t* pixel = &out[4 * i];
    if (from.face < 0 && view == 0) std::fill(pixel, pixel + 4, std::uint8_t{0});
    if (from.face != static_cast<int>(view)) continue;
    const auto x = static_cast<std::size_t>(from.x), y = static_cast<std::size_t>(from.y);
    const auto fx = static_cast<std::uint32_t>((from.x - static_cast<float>(x)) * 256),
               fy = static_cast<std::uint32_t>((from.y - static_cast<float>(y)) * 256);
    const std::uint8_t* p = &source[y * row + 4 * x];
    for (std::size_t c = 0; c < 4; ++c) {
      const std::uint32_t top = p[c] * (256 - fx) + p[c + 4] * fx;
      const std::uint32_t bottom = p[row + c] * (256 - fx) + p[row + c + 4] * fx;
      pixel[c] = static_cast<std::uint8_t>((top * (256 - fy) + bottom * fy + 32768) >> 16);
    }
  }
}

void Lens::map_marks(std::size_t view, std::span<const std::uint32_t> source, std::span<std::uint32_t> out) const {
  const auto row = static_cast<std::size_t>(faces_[view].width);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& from = sources_[i];
    if (from.face < 0 && view == 0) out[i] = 0;
    if (from.face != static_cast<int>(view)) continue;
    out[i] = source[static_cast<std::size_t>(from.y + 0.5F) * row + static_cast<std::size_t>(from.x + 0.5F)];
  }
}

void Lens::map_depth(std::span<const float> source, std::span<float> out) const {
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const Source& from = sources_[i];
    const auto x = static_cast<std::size_t>(from.x + 0.5F), y = static_cast<std::size_t>(from.y + 0.5F);
    out[i] = from.face == 0 ? source[y * static_cast<std::size_t>(faces_[0].width) + x] : std::numeric_limits<float>::infinity();
  }
}

void Lens::points(std::span<const float> depth, std::span<float> out) const {
  constexpr float none = std::numeric_limits<float>::quiet_NaN();
  const Face& face = faces_[0];
  const std::size_t count = std::min({sources_.size(), depth.size(), out.size() / 3});
  for (std::size_t i = 0; i < count; ++i) {
    const Source& from = sources_[i];
    const bool is_hit = from.face == 0 && std::isfinite(depth[i]);
    const double right = face.left + (from.x + 0.5) / face.width * (face.right - face.left);
    const double up = face.top - (from.y + 0.5) / face.height * (face.top - face.bottom);
    out[3 * i] = is_hit ? depth[i] : none;
    out[3 * i + 1] = is_hit ? static_cast<float>(-right * depth[i]) : none;
    out[3 * i + 2] = is_hit ? static_cast<float>(up * depth[i]) : none;
  }
}

}  // namespace sim

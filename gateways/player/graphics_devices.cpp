#include "graphics_devices.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/log.h"

namespace gateway {
namespace {

constexpr std::size_t max_parts = 1000;
constexpr double height_2d = 0.05;                      // [m] over the ground, which would hide it
constexpr double line_width = 0.02, point_size = 0.05;  // [m]
constexpr double farthest = 1e4;                        // [m]

bool is_drawable(const Eigen::Vector3d& point) { return point.allFinite() && point.cwiseAbs().maxCoeff() <= farthest; }

std::string sdf_pose(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix3d& r = pose.linear();
  const Eigen::Vector3d& p = pose.translation();
  return fmt::format("{} {} {} {} {} {}", p.x(), p.y(), p.z(), std::atan2(r(2, 1), r(2, 2)),
                     std::atan2(-r(2, 0), std::hypot(r(2, 1), r(2, 2))), std::atan2(r(1, 0), r(0, 0)));
}

std::string sdf_box(double x, double y, double z) { return fmt::format("<box><size>{} {} {}</size></box>", x, y, z); }

// x along the first vector, z across both.
std::optional<Eigen::Matrix3d> axes_along(const Eigen::Vector3d& along, const Eigen::Vector3d& beside) {
  Eigen::Matrix3d out;
  const Eigen::Vector3d across = along.cross(beside);
  if (!(across.norm() > 1e-12)) return std::nullopt;
  out.col(0) = along.normalized();
  out.col(2) = across.normalized();
  out.col(1) = out.col(2).cross(out.col(0));
  return out;
}

std::vector<Eigen::Vector3d> lifted(const std::vector<player::Point2d>& points) {
  std::vector<Eigen::Vector3d> out;
  for (const auto& point : points) out.emplace_back(point.x, point.y, height_2d);
  return out;
}

}  // namespace

template <class Act>
auto Graphics::later(Act act) {
  return [weak = std::weak_ptr(self_), act](const base::Result<shm::Reply>& reply) {
    if (const auto self = weak.lock()) act(**self, reply);
  };
}

void Graphics::on_attach() {
  drawn_.clear();
  is_drawing_ = false;
}

void Graphics::on_unused() {
  clear();
  draw();
}

void Graphics::clear() { parts_.clear(), is_changed_ = true; }

bool Graphics::has_room() {
  if (parts_.size() < max_parts) return true;
  if (!std::exchange(has_complained_, true))
    base::log(base::Level::warn, "player-gateway", "{}: more than {} points, lines and faces are not drawn", player::to_text(address()),
              max_parts);
  return false;
}

void Graphics::add(const Eigen::Isometry3d& pose, const std::string& geometry, const player::Color& color) {
  const double alpha = color.alpha == 0 ? 1 : color.alpha / 255.0;  // most clients do not set it
  // As bright in the dark.
  parts_.push_back(fmt::format(
      "<visual name=\"v{}\"><cast_shadows>false</cast_shadows><pose>{}</pose><geometry>{}</geometry><material><ambient>0 0 0 {}</ambient>"
      "<diffuse>0 0 0 {}</diffuse><emissive>{} {} {} 1</emissive></material></visual>",
      parts_.size(), sdf_pose(pose), geometry, alpha, alpha, color.red / 255.0, color.green / 255.0, color.blue / 255.0));
  is_changed_ = true;
}

void Graphics::add_points(const Points& points, const player::Color& color) {
  for (const auto& point : points) {
    if (!is_drawable(point) || !has_room()) continue;
    add(Eigen::Isometry3d(Eigen::Translation3d(point)), sdf_box(point_size, point_size, point_size), color);
  }
}

void Graphics::add_lines(const Points& points, bool is_closed, const player::Color& color) {
  for (std::size_t i = 0; i + (is_closed ? 0 : 1) < points.size(); ++i) {
    const Eigen::Vector3d &a = points[i], &b = points[(i + 1) % points.size()], along = b - a;
    if (!is_drawable(a) || !is_drawable(b) || !has_room()) continue;
    const bool is_upright = along.head<2>().norm() < 1e-6 * along.norm();
    const auto directions =
        axes_along(along, is_upright ? Eigen::Vector3d(Eigen::Vector3d::UnitX()) : Eigen::Vector3d(Eigen::Vector3d::UnitZ()));
    if (!directions) continue;  // without length
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = *directions;
    pose.translation() = 0.5 * (a + b);
    add(pose, sdf_box(along.norm(), line_width, line_width), color);
  }
}

void Graphics::add_face(const Points& points, const player::Color& color) {
  if (points.size() < 3 || !std::ranges::all_of(points, is_drawable) || !has_room()) return;
  std::optional<Eigen::Matrix3d> directions;
  for (std::size_t i = 2; i < points.size() && !directions; ++i) directions = axes_along(points[1] - points[0], points[i] - points[0]);
  if (!directions) return;  // without area
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = *directions;
  pose.translation() = points[0];
  std::string outline = "<polyline>";
  for (const auto& point : points) {
    const Eigen::Vector3d place = directions->transpose() * (point - points[0]);
    outline += fmt::format("<point>{} {}</point>", place.x(), place.y());
  }
  add(pose, outline + "<height>0.002</height></polyline>", color);
}

// Where the robot is, then the new drawing, then without the old one. What has changed meanwhile is drawn afterwards.
void Graphics::draw() {
  if (is_drawing_ || !is_changed_ || !source()) return;
  is_drawing_ = true;
  is_changed_ = false;
  if (parts_.empty()) return erase(std::exchange(drawn_, ""));
  if (iface().type() == shm::IfaceType::simulation) return spawn(std::nullopt);
  const bool is_flat = iface().type() == shm::IfaceType::position2d;
  const std::string model = is_flat ? iface().info<shm::Position2dInfo>().model : iface().info<shm::Position3dInfo>().model;
  services_.async_requests.post(shm::GetPoseRequest{model}, later([](Graphics& self, const base::Result<shm::Reply>& reply) {
                                  if (!reply) return self.end_drawing();
                                  const double* v = reply->values;
                                  self.spawn(shm::Pose{v[0], v[1], v[2], v[3], v[4], v[5], v[6]});
                                }));
}

void Graphics::spawn(const std::optional<shm::Pose>& pose) {
  shm::SpawnRequest request;
  const std::string name = fmt::format("player_{}_{}_{}_{}", port(), player::to_text(address().interface), address().index, ++number_ % 2);
  request.sdf = "<sdf version=\"1.9\"><model name=\"" + name + "\"><static>true</static><link name=\"drawing\">";
  for (const auto& part : parts_) request.sdf += part;
  request.sdf += "</link></model></sdf>";
  request.has_pose = pose.has_value();
  if (pose) request.pose = *pose;
  request.is_confined = true;
  services_.async_requests.post(std::move(request), later([name](Graphics& self, const base::Result<shm::Reply>& reply) {
                                  if (!reply) {
                                    base::log(base::Level::warn, "player-gateway", "{}: {}", player::to_text(self.address()),
                                              reply.error().message);
                                    return self.end_drawing();
                                  }
                                  self.erase(std::exchange(self.drawn_, name));
                                }));
}

void Graphics::erase(const std::string& model) {
  if (model.empty()) return end_drawing();
  services_.async_requests.post(shm::DeleteRequest{model},
                                later([](Graphics& self, const base::Result<shm::Reply>&) { self.end_drawing(); }));
}

void Graphics::end_drawing() {
  is_drawing_ = false;
  draw();
}

// ---- 2D ----

void Graphics2d::obey(Client&, std::uint8_t subtype, const std::string& payload) {
  enum : std::uint8_t { clear_all = 1, points = 2, polyline = 3, polygon = 4, multiline = 5 };
  if (subtype == clear_all) {
    clear();
  } else if (subtype == polygon) {
    const auto shape = player::decode_polygon(payload);
    if (!shape) return;
    if (shape->is_filled) add_face(lifted(shape->points), shape->fill);
    add_lines(lifted(shape->points), true, shape->color);
  } else {
    const auto shape = player::decode_points(payload);
    if (!shape) return;
    const Points all = lifted(shape->points);
    if (subtype == points) add_points(all, shape->color);
    if (subtype == polyline) add_lines(all, false, shape->color);
    for (std::size_t i = 0; subtype == multiline && i + 1 < all.size(); i += 2) add_lines({all[i], all[i + 1]}, false, shape->color);
  }
  Graphics::draw();
}

// ---- 3D ----

void Graphics3d::obey(Client&, std::uint8_t subtype, const std::string& payload) {
  enum : std::uint8_t { clear_all = 1, drawing = 2, translate = 3, rotate = 4, push = 5, pop = 6 };
  constexpr std::size_t deepest = 100;
  if (subtype == clear_all) {
    clear();
    frames_.clear();
    frame_.setIdentity();
  } else if (subtype == drawing) {
    if (const auto wanted = player::decode_drawing(payload)) draw(*wanted);
  } else if (subtype == translate) {
    const auto by = player::decode_point(payload);
    const Eigen::Vector3d way = by ? Eigen::Vector3d(by->x, by->y, by->z) : Eigen::Vector3d::Zero();
    if (is_drawable(way)) frame_.translate(way);
  } else if (subtype == rotate) {
    const auto by = player::decode_rotation(payload);
    if (!by || !std::isfinite(by->angle)) return;
    const Eigen::Vector3d axis(by->axis.x, by->axis.y, by->axis.z);
    if (axis.allFinite() && axis.norm() > 1e-9 && axis.norm() < 1e9) frame_.rotate(Eigen::AngleAxisd(by->angle, axis.normalized()));
  } else if (subtype == push) {
    if (frames_.size() < deepest) frames_.push_back(frame_);
  } else if (!frames_.empty()) {
    frame_ = frames_.back();
    frames_.pop_back();
  }
  Graphics::draw();
}

void Graphics3d::draw(const player::Drawing& drawing) {
  using Mode = player::Drawing::Mode;
  Points all;
  for (const auto& point : drawing.points) all.push_back(frame_ * Eigen::Vector3d(point.x, point.y, point.z));
  const auto& color = drawing.color;
  const auto faces = [&](std::size_t corners, std::size_t step, bool is_fan) {
    for (std::size_t i = 0; i + corners <= all.size(); i += step) {
      Points face(all.begin() + static_cast<std::ptrdiff_t>(i), all.begin() + static_cast<std::ptrdiff_t>(i + corners));
      if (is_fan) face[0] = all[0];
      if (corners == 4 && step == 2) std::swap(face[2], face[3]);  // of a strip: rungs of a ladder
      add_face(face, color);
    }
  };
  switch (drawing.mode) {
    case Mode::points:
      return add_points(all, color);
    case Mode::lines:
      for (std::size_t i = 0; i + 1 < all.size(); i += 2) add_lines({all[i], all[i + 1]}, false, color);
      return;
    case Mode::line_strip:
      return add_lines(all, false, color);
    case Mode::line_loop:
      return add_lines(all, true, color);
    case Mode::triangles:
      return faces(3, 3, false);
    case Mode::triangle_strip:
      return faces(3, 1, false);
    case Mode::triangle_fan:
      return faces(3, 1, true);
    case Mode::quads:
      return faces(4, 4, false);
    case Mode::quad_strip:
      return faces(4, 2, false);
    case Mode::polygon:
      return add_face(all, color);
  }
}

}  // namespace gateway

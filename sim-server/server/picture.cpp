#include "server/picture.h"

#include <png.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "devices/laser.h"

namespace sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<std::uint32_t, 6> fan_colors = {0x2060ff, 0x20b040, 0xe08020,
                                                     0xb030c0, 0x20b0b0, 0xc03030};  // the leader is blue, the follower green

// What of the world has an end: the box around all shapes but planes.
Eigen::AlignedBox3d bounds_of(const Physics& physics) {
  Eigen::AlignedBox3d box;
  for (ModelId id = 0; id < physics.model_slots(); ++id) {
    if (!physics.exists(id)) continue;
    const ModelDef& model = physics.def(id);
    for (std::uint32_t l = 0; l < model.links.size(); ++l) {
      const Eigen::Isometry3d link = physics.link_pose({id, l});
      for (const auto& collision : model.links[l].collisions) {
        Vector3d half(0.5, 0.5, 0.5);
        if (std::holds_alternative<PlaneShape>(collision.geometry)) continue;
        if (const auto* b = std::get_if<BoxShape>(&collision.geometry)) half = b->size / 2;
        if (const auto* s = std::get_if<SphereShape>(&collision.geometry)) half.setConstant(s->radius);
        if (const auto* c = std::get_if<CylinderShape>(&collision.geometry)) half = {c->radius, c->radius, c->length / 2};
        if (const auto* h = std::get_if<HeightmapShape>(&collision.geometry)) half = h->size / 2;
        const Eigen::Isometry3d pose = link * collision.pose;
        const Vector3d reach = pose.linear().cwiseAbs() * half;
        box.extend((pose.translation() - reach).eval());
        box.extend((pose.translation() + reach).eval());
      }
    }
  }
  if (box.isEmpty()) box.extend(Vector3d(-5, -5, 0)), box.extend(Vector3d(5, 5, 1));
  return box;
}

std::uint32_t scaled(std::uint32_t color, double by) {
  const auto part = [&](int shift) { return static_cast<std::uint32_t>(std::clamp((color >> shift & 255U) * by, 0.0, 255.0)) << shift; };
  return part(16) | part(8) | part(0);
}

void put(Image& image, int x, int y, std::uint32_t color, double opacity) {
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return;
  std::uint8_t* p = &image.rgb[3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x))];
  for (int i = 0; i < 3; ++i) {
    const double part = static_cast<double>(color >> (16 - 8 * i) & 255U);
    p[i] = static_cast<std::uint8_t>(std::lround(p[i] + (part - p[i]) * opacity));
  }
}

std::uint32_t color_of_hit(const RayHit& hit, const Vector3d& point) {
  const Eigen::Vector3f light = Eigen::Vector3f(0.3F, 0.4F, 1).normalized();
  double brightness = 0.45 + 0.6 * std::max(0.0F, std::abs(hit.normal.dot(light)));
  if (std::abs(hit.normal.z()) > 0.999F && std::abs(point.z()) < 0.005) {  // level ground: a grid of metres
    const auto near_line = [](double v) { return std::abs(v - std::round(v)) < 0.012; };
    if (near_line(point.x()) || near_line(point.y())) brightness *= 0.85;
    return scaled(0xd8d8d4, std::min(brightness, 1.05));
  }
  return scaled(hit.color, brightness);
}

Image draw_with_rays(const Simulation& simulation, RayWorld& rays, const View& view, int width, int height) {
  Image image{width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3, 0)};
  const Color& sky = simulation.world().scene.background;
  const auto byte = [](float v) { return static_cast<std::uint32_t>(std::clamp(v, 0.0F, 1.0F) * 255); };
  const std::uint32_t background = byte(sky.r) << 16 | byte(sky.g) << 8 | byte(sky.b);
  rays.update();
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Vector3d origin, direction;
      view.ray(x + 0.5, y + 0.5, origin, direction);
      const RayHit hit = rays.scene().trace_one(origin, direction, 0, 10000);
      put(image, x, y, std::isfinite(hit.range) ? color_of_hit(hit, origin + static_cast<double>(hit.range) * direction) : background, 1);
    }
  }
  return image;
}

double edge(const Vector2d& a, const Vector2d& b, const Vector2d& p) {
  return (b.x() - a.x()) * (p.y() - a.y()) - (b.y() - a.y()) * (p.x() - a.x());
}

// Marks the pixels of a triangle.
void fill(std::vector<bool>& mask, const Image& image, const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const double area = edge(a, b, c);
  if (area == 0 || !std::isfinite(area)) return;
  const auto bound = [](double v, int limit) { return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(limit))); };
  const int x0 = bound(std::floor(std::min({a.x(), b.x(), c.x()})), image.width),
            x1 = bound(std::ceil(std::max({a.x(), b.x(), c.x()})), image.width);
  const int y0 = bound(std::floor(std::min({a.y(), b.y(), c.y()})), image.height),
            y1 = bound(std::ceil(std::max({a.y(), b.y(), c.y()})), image.height);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      const Vector2d p(x + 0.5, y + 0.5);
      const double u = edge(a, b, p) / area, v = edge(b, c, p) / area, w = edge(c, a, p) / area;
      if (u >= 0 && v >= 0 && w >= 0)
        mask[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)] = true;
    }
  }
}

void draw_line(Image& image, Vector2d a, Vector2d b, std::uint32_t color, double opacity) {
  const double length = (b - a).norm();
  if (!(length < 1e5)) return;
  const int count = std::max(1, static_cast<int>(std::ceil(length)));
  for (int i = 0; i < count; ++i) {
    const Vector2d p = a + (b - a) * (static_cast<double>(i) / count);
    const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
    put(image, x, y, color, opacity);
    put(image, x + 1, y, color, opacity * 0.6);
    put(image, x, y + 1, color, opacity * 0.6);
  }
}

void draw_scan(Image& image, const View& view, const std::vector<Vector3d>& rim, const Vector3d& origin, std::uint32_t color) {
  Vector2d center;
  if (!view.project(origin, center)) return;
  std::vector<bool> mask(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height), false);
  Vector2d before, now;
  bool has_before = false;
  std::vector<std::pair<Vector2d, Vector2d>> outline;
  for (const auto& point : rim) {
    const bool is_there = view.project(point, now);
    if (is_there && has_before) {
      fill(mask, image, center, before, now);
      outline.emplace_back(before, now);
    }
    before = now;
    has_before = is_there;
  }
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (mask[static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)])
        put(image, x, y, color, 0.28);
    }
  }
  for (const auto& [a, b] : outline) draw_line(image, a, b, color, 0.5);
}

void draw_scans(Image& image, Simulation& simulation, const View& view) {
  std::size_t number = 0;
  for (const auto& device : simulation.devices()) {
    auto* laser = dynamic_cast<Laser*>(device.get());
    if (laser == nullptr) continue;
    Vector3d origin;
    const auto rim = laser->look(origin);
    draw_scan(image, view, rim, origin, fan_colors[number++ % fan_colors.size()]);
  }
}

void draw_trails(Image& image, const Simulation& simulation, const View& view) {
  for (std::size_t id = 0; id < simulation.trails().size(); ++id) {
    const auto& points = simulation.trails()[id].points;
    Vector2d a, b;
    for (std::size_t i = 1; i < points.size(); ++i) {
      if (view.project(points[i - 1].cast<double>(), a) && view.project(points[i].cast<double>(), b)) draw_line(image, a, b, 0x303030, 0.7);
    }
  }
}

}  // namespace

View View::top(const Vector3d& center, double across, double height, int width_px, int height_px) {
  View view;
  view.pose_.translation() = Vector3d(center.x(), center.y(), height);
  view.scale_ = width_px / across;
  view.width_ = width_px;
  view.height_ = height_px;
  return view;
}

View View::camera(const Eigen::Isometry3d& pose, double hfov, int width_px, int height_px) {
  View view;
  view.is_top_ = false;
  view.pose_ = pose;
  view.scale_ = width_px / 2.0 / std::tan(hfov / 2);
  view.width_ = width_px;
  view.height_ = height_px;
  return view;
}

bool View::project(const Vector3d& point, Vector2d& pixel) const {
  const Vector3d p = pose_.inverse() * point;
  if (is_top_) {
    pixel = {width_ / 2 + p.x() * scale_, height_ / 2 - p.y() * scale_};
    return true;
  }
  if (p.x() < 0.02) return false;
  pixel = {width_ / 2 - p.y() / p.x() * scale_, height_ / 2 - p.z() / p.x() * scale_};
  return true;
}

void View::ray(double px, double py, Vector3d& origin, Vector3d& direction) const {
  if (is_top_) {
    origin = pose_.translation() + Vector3d((px - width_ / 2) / scale_, (height_ / 2 - py) / scale_, 0);
    direction = {0, 0, -1};
    return;
  }
  origin = pose_.translation();
  direction = pose_.linear() * Vector3d(scale_, width_ / 2 - px, height_ / 2 - py).normalized();
}

base::Result<View> view_of(const Simulation& simulation, const shm::ScreenshotRequest& request) {
  using Kind = shm::ScreenshotRequest::View;
  const Eigen::AlignedBox3d bounds = bounds_of(simulation.physics());
  const int width = static_cast<int>(request.width), height = static_cast<int>(request.height);
  const double above = bounds.max().z() + 10;
  if (request.view == Kind::from)
    return View::camera(from_pose(request.pose), request.span > 0 ? std::min(request.span, 3.0) : 1.2, width, height);
  if (request.view == Kind::follow) {
    const auto model = simulation.physics().find(request.follow);
    if (!model) return base::Error{"screenshot: no model " + request.follow};
    return View::top(simulation.physics().model_pose(*model).translation(), request.span > 0 ? request.span : 8, above, width, height);
  }
  // The whole world: from above, or obliquely from the south.
  const double fit = 1.08 * std::max(bounds.sizes().x(), bounds.sizes().y() * width / height);
  const Vector3d middle = bounds.center();
  if (request.view == Kind::top) {
    const bool has_centre = request.span > 0;
    const Vector3d center = has_centre ? Vector3d(request.pose.x, request.pose.y, 0) : middle;
    return View::top(center, has_centre ? request.span : std::max(fit, 1.0), above, width, height);
  }
  const double distance = std::max(fit, 2.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Vector3d(middle.x(), middle.y(), 0) + Vector3d(0, -0.75 * distance, 0.7 * distance);
  pose.rotate(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()) * Eigen::AngleAxisd(0.75, Vector3d::UnitY()));
  return View::camera(pose, 1.1, width, height);
}

base::Result<Image> draw_picture(Simulation& simulation, const shm::ScreenshotRequest& request) {
  const auto view = view_of(simulation, request);
  if (!view) return view.error();
  Image image = draw_with_rays(simulation, simulation.rays(), *view, static_cast<int>(request.width), static_cast<int>(request.height));
  draw_trails(image, simulation, *view);
  if (request.with_scans) draw_scans(image, simulation, *view);
  return image;
}

base::Result<void> write_png(const Image& image, const std::filesystem::path& path) {
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  const std::string beside = path.string() + "." + std::to_string(getpid()) + ".part";
  if (png_image_write_to_file(&png, beside.c_str(), 0, image.rgb.data(), 0, nullptr) == 0) {
    const std::string reason = png.message;
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    return base::Error{"picture " + path.string() + ": " + reason};
  }
  std::error_code error;
  std::filesystem::rename(beside, path, error);
  if (error) {
    std::error_code ignored;
    std::filesystem::remove(beside, ignored);
    return base::Error{"picture " + path.string() + ": " + error.message()};
  }
  return {};
}

}  // namespace sim

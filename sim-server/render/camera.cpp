#include "render/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/formats.h"
#include "render/marks.h"
#include "render/pixels.h"

namespace sim {
namespace {

constexpr double widest_pinhole = 3.1;  // [rad]

bool has_color(Camera::Output output) {
  return output == Camera::Output::color || output == Camera::Output::color_and_depth || output == Camera::Output::color_and_marks;
}
bool has_depth(Camera::Output output) { return output == Camera::Output::depth || output == Camera::Output::color_and_depth; }
bool has_marks(Camera::Output output) { return output == Camera::Output::marks || output == Camera::Output::color_and_marks; }

}  // namespace

Camera::Camera(const CameraDef& def, Output output, std::uint64_t seed) : def_(def), output_(output), seed_(seed), lens_(Lens::make(def)) {
  def_.horizontal_fov = lens_ ? def_.horizontal_fov : std::min(def_.horizontal_fov, widest_pinhole);
}

std::size_t Camera::pixels() const { return static_cast<std::size_t>(def_.width) * static_cast<std::size_t>(def_.height); }
std::size_t Camera::color_bytes() const { return pixels() * bytes_per_pixel(def_.format); }
double Camera::focal_length() const { return 0.5 * def_.width / std::tan(0.5 * std::min(def_.horizontal_fov, widest_pinhole)); }

// Of a distorting lens: the point that it leaves where it is.
Eigen::Vector2d Camera::principal_point() const {
  const Eigen::Vector2d middle = lens_ && def_.distortion ? def_.distortion->center : Eigen::Vector2d(0.5, 0.5);
  return {middle.x() * def_.width, middle.y() * def_.height};
}

base::Result<void> Camera::take(Renderer& renderer, const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses,
                                const Eigen::Isometry3d& pose, std::int64_t time, Output wanted) {
  time_ = time;
  // The first picture brings them; most cameras of a world are never looked at.
  if (has_color(output_)) rgba_.resize(pixels() * 4);
  if (has_depth(output_)) depth_.resize(pixels());
  if (has_marks(output_)) marks_.resize(pixels());
  View plain = View::pinhole(pose, def_.horizontal_fov, def_.width, def_.height);
  plain.near_clip = def_.near_clip;
  plain.far_clip = def_.far_clip;
  std::vector<View> views = lens_ ? lens_->views(pose) : std::vector<View>{plain};
  for (std::size_t i = 0; i < views.size(); ++i) {
    View& view = views[i];
    view.visibility_mask = def_.visibility_mask;
    view.wants_color = has_color(wanted);
    view.wants_exact_depth = has_depth(output_);  // whoever looks at the moment: the colours are always the same
    view.wants_objects = wanted == Output::color_and_marks && !lens_ && can_show_objects(*scene);
    if (has_marks(wanted) && !view.wants_objects) {
      if (auto drawn = take_marks(renderer, scene, poses, view, i); !drawn) return drawn;
    }
    if (wanted == Output::marks) continue;
    if (auto drawn = renderer.draw(scene, poses, view); !drawn) return drawn;
    const std::size_t count = static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    if (view.wants_color) {
      if (lens_) face_rgba_.resize(count * 4);
      renderer.read_rgba(lens_ ? face_rgba_ : rgba_);
      if (lens_) lens_->map_rgba(i, face_rgba_, rgba_);
      if (view.wants_objects) take_objects(*scene);
    }
    if (has_depth(wanted) && i == 0) {
      if (lens_) face_depth_.resize(count);
      renderer.read_depth(lens_ ? face_depth_ : depth_);
      if (lens_) lens_->map_depth(face_depth_, depth_);
    }
  }
  if (has_depth(wanted)) add_depth_noise();
  return {};
}

base::Result<void> Camera::take_marks(Renderer& renderer, const std::shared_ptr<const Scene>& scene,
                                      std::span<const Eigen::Isometry3d> poses, View view, std::size_t index) {
  view.wants_color = view.wants_marks = true;
  if (auto drawn = renderer.draw(scene, poses, view); !drawn) return drawn;
  if (lens_) face_marks_.resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height));
  auto& drawn_marks = lens_ ? face_marks_ : marks_;
  renderer.read_rgba({reinterpret_cast<std::uint8_t*>(drawn_marks.data()), drawn_marks.size() * 4});
  if (lens_) lens_->map_marks(index, face_marks_, marks_);
  return {};
}

void Camera::take_objects(const Scene& scene) {
  std::vector<std::uint32_t> mark_of(256);
  for (std::size_t i = scene.visuals.size(); i-- > 0;) {
    if (scene.visuals[i].object != 0) mark_of[scene.visuals[i].object] = static_cast<std::uint32_t>(i + 1);
  }
  for (std::size_t i = 0; i < marks_.size(); ++i) {
    std::uint8_t& opacity = rgba_[4 * i + 3];
    marks_[i] = mark_of[opacity];
    opacity = 255;
  }
}

void Camera::add_depth_noise() {
  if (def_.depth_clip) {
    const auto nearest = static_cast<float>(def_.depth_clip->first), farthest = static_cast<float>(def_.depth_clip->second);
    for (auto& d : depth_) d = d < nearest || d > farthest ? std::numeric_limits<float>::infinity() : d;
  }
  // The noise of an rgbd camera is that of its colours.
  if (def_.noise.kind == NoiseDef::Kind::none || output_ != Output::depth) return;
  NoiseStream(mix_seed(seed_, static_cast<std::uint64_t>(time_))).add(std::span<float>(depth_), def_.noise.mean, def_.noise.stddev);
}

void Camera::write_color(std::span<std::uint8_t> out) const {
  out = out.first(std::min(out.size(), color_bytes()));
  convert_rgba(rgba_, def_.width, def_.format, out);
  if (def_.noise.kind == NoiseDef::Kind::none) return;
  add_noise(mix_seed(seed_, static_cast<std::uint64_t>(time_)), def_.noise.mean, def_.noise.stddev, def_.format, out);
}

void Camera::write_heat(const Scene& scene, double air, std::span<std::uint8_t> out) const {
  std::vector<float> kelvin;
  write_temperatures(scene, marks_, air, kelvin);
  if (def_.noise.kind != NoiseDef::Kind::none)
    NoiseStream(mix_seed(seed_, static_cast<std::uint64_t>(time_))).add(std::span<float>(kelvin), def_.noise.mean, def_.noise.stddev);
  write_thermal(kelvin, def_.thermal, out);
}

void Camera::write_points(std::span<float> out) const {
  if (lens_) return lens_->points(depth_, out);
  const double f = focal_length();
  const Eigen::Vector2d c = principal_point();
  depth_to_points(depth_, def_.width, f, f, c.x(), c.y(), out);
}

}  // namespace sim

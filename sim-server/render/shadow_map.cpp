#include "render/shadow_map.h"

#include <algorithm>
#include <cmath>

namespace sim {
namespace {

constexpr double largest_region = 120;  // [m] that one map covers; beyond, it follows the focus
constexpr double focus_region = 80;     // [m]
constexpr double focus_step = 20;       // [m]
constexpr double region_step = 2;       // [m]; what moves within it leaves the map as it is

Eigen::Matrix3d axes_for(const Eigen::Vector3d& to_light) {
  const Eigen::Vector3d other = std::abs(to_light.z()) < 0.99 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitX();
  Eigen::Matrix3d axes;
  axes.row(2) = to_light.transpose();
  axes.row(0) = other.cross(to_light).normalized().transpose();
  axes.row(1) = to_light.cross(Eigen::Vector3d(axes.row(0))).transpose();
  return axes;
}

bool is_caster(const Drawable& drawable) { return drawable.casts_shadow && !drawable.is_ground; }

bool is_same(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) { return a.matrix() == b.matrix(); }

}  // namespace

ShadowMap::ShadowMap(const gl::Functions& gl, GpuStore& store) : gl_(gl), store_(store) {}

void ShadowMap::allocate(int size) {
  framebuffer_ = gl::Object(gl_.GenFramebuffers, gl_.DeleteFramebuffers);
  for (gl::Object* map : {&kept_, &working_}) {
    *map = gl::Object(gl_.GenTextures, gl_.DeleteTextures);
    gl_.BindTexture(GL_TEXTURE_2D, map->name());
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, size, size, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
  }
  size_ = size;
}

Eigen::Vector3d ShadowMap::snapped(const Eigen::Vector3d& focus) const {
  const Eigen::Vector3d p = axes_ * focus;
  return {std::round(p.x() / focus_step) * focus_step, std::round(p.y() / focus_step) * focus_step, 0};
}

// All casters, in steps: it follows from where they are now, not from where they were at the first picture.
Eigen::AlignedBox3d ShadowMap::region_of(const Scene& scene, std::span<const Eigen::Isometry3d> poses) const {
  Eigen::AlignedBox3d region;
  for (const auto& drawable : scene.drawables) {
    if (!is_caster(drawable)) continue;
    const Eigen::Vector3d centre = axes_ * (poses[drawable.link] * drawable.centre);
    region.extend(Eigen::Vector3d(centre - Eigen::Vector3d::Constant(drawable.radius)));
    region.extend(Eigen::Vector3d(centre + Eigen::Vector3d::Constant(drawable.radius)));
  }
  if (region.isEmpty()) return {Eigen::Vector3d::Constant(-1), Eigen::Vector3d::Constant(1)};
  return {Eigen::Vector3d((region.min() / region_step).array().floor() * region_step),
          Eigen::Vector3d((region.max() / region_step).array().ceil() * region_step)};
}

void ShadowMap::fit(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const Eigen::Vector3d& to_light,
                    const Eigen::Vector3d& focus) {
  to_light_ = to_light;
  axes_ = axes_for(to_light);
  region_ = region_of(scene, poses);
  covers_all_ = region_.sizes().head<2>().maxCoeff() <= largest_region;
  focus_ = snapped(focus);
  const double side = covers_all_ ? region_.sizes().head<2>().maxCoeff() * 1.02 : focus_region;
  const Eigen::Vector3d middle = covers_all_ ? Eigen::Vector3d(region_.center()) : focus_;
  const double near = region_.max().z() + 1, far = region_.min().z() - 1;
  texel_ = side / size_;
  // Depth 0 at the light's side. Casters nearer to the light than the region are clamped, not clipped.
  Eigen::Matrix4d scale = Eigen::Matrix4d::Identity();
  scale(0, 0) = scale(1, 1) = 2 / side;
  scale(2, 2) = -2 / (near - far);
  scale(0, 3) = -2 * middle.x() / side;
  scale(1, 3) = -2 * middle.y() / side;
  scale(2, 3) = (near + far) / (near - far);
  Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
  turn.topLeftCorner<3, 3>() = axes_;
  to_clip_ = scale * turn;
  Eigen::Matrix4d half = Eigen::Matrix4d::Identity();
  half.topLeftCorner<3, 3>() *= 0.5;
  half.topRightCorner<3, 1>().setConstant(0.5);
  to_map_ = half * to_clip_;
}

bool ShadowMap::still_fits(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const Eigen::Vector3d& to_light,
                           const Eigen::Vector3d& focus, int size) const {
  if (!is_valid_ || size != size_ || poses.size() != poses_.size() || to_light != to_light_) return false;
  if (!covers_all_ && snapped(focus) != focus_) return false;
  const auto stands = [&](const Drawable& drawable) {
    return !is_caster(drawable) || !scene.links[drawable.link].is_static || is_same(poses[drawable.link], poses_[drawable.link]);
  };
  if (!std::ranges::all_of(scene.drawables, stands)) return false;
  const Eigen::AlignedBox3d region = region_of(scene, poses);
  return region.min() == region_.min() && region.max() == region_.max();
}

// Whether the shadow of the sphere round it, from the ceiling to the floor, is not wholly on the outer side of one plane.
bool ShadowMap::may_be_seen(const Drawable& drawable, const Eigen::Isometry3d& pose, const ShadowView& view) const {
  constexpr double flattest = 0.05;  // below, shadows have no end
  if (to_light_.z() < flattest) return true;
  const Eigen::Vector3d centre = pose * drawable.centre;
  const double radius = drawable.radius + 4 * texel_;
  const auto way_to = [&](double z) { return std::max(0.0, (centre.z() - z) / to_light_.z()); };
  const Eigen::Vector3d begin = centre - way_to(view.ceiling + radius) * to_light_ - view.eye;
  const Eigen::Vector3d end = centre - way_to(view.floor - radius) * to_light_ - view.eye;
  return std::none_of(view.planes.begin(), view.planes.end(), [&](const Eigen::Vector4d& plane) {
    return std::max(plane.head<3>().dot(begin), plane.head<3>().dot(end)) + plane.w() < -radius;
  });
}

// What never moves, in both maps.
base::Result<void> ShadowMap::rebuild(const Scene& scene, std::span<const Eigen::Isometry3d> poses) {
  std::vector<bool> statics;
  for (const auto& drawable : scene.drawables) statics.push_back(is_caster(drawable) && scene.links[drawable.link].is_static);
  for (const auto& map : {&kept_, &working_}) {
    gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map->name(), 0);
    gl_.Disable(GL_SCISSOR_TEST);
    gl_.Clear(GL_DEPTH_BUFFER_BIT);
    gl_.Enable(GL_SCISSOR_TEST);
    if (auto done = draw(scene, poses, statics); !done) return done;
  }
  dirty_.clear();
  ++rebuilds_;
  return {};
}

base::Result<void> ShadowMap::update(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const Eigen::Vector3d& to_light,
                                     const ShadowView& view, int size) {
  if (size != size_) allocate(size);
  const bool is_kept = still_fits(scene, poses, to_light, view.focus, size) && gl_.CopyImageSubData != nullptr;
  bool has_moved = !is_kept;
  for (std::size_t i = 0; i < poses.size() && !has_moved; ++i) has_moved = !is_same(poses[i], poses_[i]);
  if (!is_kept) {
    is_valid_ = false;
    fit(scene, poses, to_light, view.focus);
  }
  if (has_moved) drawn_.assign(scene.drawables.size(), false);
  std::vector<bool> movers(scene.drawables.size(), false);
  bool is_any = false;
  for (std::size_t i = 0; i < movers.size(); ++i) {
    const Drawable& drawable = scene.drawables[i];
    movers[i] =
        is_caster(drawable) && !scene.links[drawable.link].is_static && !drawn_[i] && may_be_seen(drawable, poses[drawable.link], view);
    is_any = is_any || movers[i];
  }
  if (!has_moved && !is_any) return {};

  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  gl_.DrawBuffer(GL_NONE);
  gl_.ReadBuffer(GL_NONE);
  gl_.Viewport(0, 0, size_, size_);
  // The outermost pixels stay lit: beyond them there is no shadow.
  gl_.Enable(GL_SCISSOR_TEST);
  gl_.Scissor(1, 1, size_ - 2, size_ - 2);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.Enable(GL_DEPTH_CLAMP);
  gl_.DepthMask(GL_TRUE);
  gl_.DepthFunc(GL_LEQUAL);
  gl_.Disable(GL_BLEND);
  gl_.CullFace(GL_BACK);
  if (!is_kept) {
    if (auto done = rebuild(scene, poses); !done) return done;
  } else if (has_moved) {
    restore_patches();
  }
  gl_.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, working_.name(), 0);
  if (auto done = draw(scene, poses, movers); !done) return done;
  gl_.Disable(GL_DEPTH_CLAMP);
  gl_.Disable(GL_SCISSOR_TEST);
  for (std::size_t i = 0; i < movers.size(); ++i) {
    if (!movers[i]) continue;
    dirty_.push_back(patch_of(scene.drawables[i], poses[scene.drawables[i].link]));
    drawn_[i] = true;
    ++moving_drawn_;
  }
  poses_.assign(poses.begin(), poses.end());
  is_valid_ = true;
  return {};
}

void ShadowMap::restore_patches() {
  for (const auto& p : dirty_) {
    if (p.right <= p.left || p.top <= p.bottom) continue;
    gl_.CopyImageSubData(kept_.name(), GL_TEXTURE_2D, 0, p.left, p.bottom, 0, working_.name(), GL_TEXTURE_2D, 0, p.left, p.bottom, 0,
                         p.right - p.left, p.top - p.bottom, 1);
  }
  dirty_.clear();
}

ShadowMap::Patch ShadowMap::patch_of(const Drawable& drawable, const Eigen::Isometry3d& pose) const {
  const Eigen::Vector4d centre = to_map_ * (pose * drawable.centre).homogeneous();
  const double radius = drawable.radius / texel_ + 1;
  const auto clamp = [&](double pixel) { return static_cast<int>(std::clamp(pixel, 0.0, static_cast<double>(size_))); };
  const double x = centre.x() * size_, y = centre.y() * size_;
  return {clamp(std::floor(x - radius)), clamp(std::floor(y - radius)), clamp(std::ceil(x + radius)), clamp(std::ceil(y + radius))};
}

base::Result<void> ShadowMap::draw(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const std::vector<bool>& which) {
  const SurfaceProgram* current = nullptr;
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (!which[i]) continue;
    const Drawable& drawable = scene.drawables[i];
    const Patch patch = patch_of(drawable, poses[drawable.link]);
    if (patch.right <= patch.left || patch.top <= patch.bottom) continue;
    Features features;
    features.depth_only = true;
    features.texture = features.holes = drawable.material.texture && drawable.material.texture->has_holes;
    auto program = store_.program(features);
    if (!program) return program.error();
    if (*program != current) {
      current = *program;
      gl_.UseProgram(current->program.name());
      const Eigen::Matrix4f clip = to_clip_.cast<float>();
      gl_.UniformMatrix4fv(current->view_projection, 1, GL_FALSE, clip.data());
    }
    const Eigen::Matrix4f model = (poses[drawable.link] * drawable.in_link).matrix().cast<float>();
    gl_.UniformMatrix4fv(current->model, 1, GL_FALSE, model.data());
    if (features.texture) {
      gl_.ActiveTexture(GL_TEXTURE0);
      gl_.BindTexture(GL_TEXTURE_2D, store_.texture(drawable.material.texture));
      gl_.Uniform1i(current->albedo_map, 0);
      gl_.Uniform2f(current->repeat, drawable.material.repeat.x(), drawable.material.repeat.y());
    }
    // Of closed shapes the sides to the light are enough.
    if (drawable.mesh->is_closed) {
      gl_.Enable(GL_CULL_FACE);
    } else {
      gl_.Disable(GL_CULL_FACE);
    }
    gl_.FrontFace(drawable.is_mirrored ? GL_CW : GL_CCW);
    const MeshPart& part = drawable.mesh->parts[drawable.part];
    gl_.BindVertexArray(store_.mesh(drawable.mesh).vertex_array.name());
    gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.index_count), GL_UNSIGNED_INT,
                     reinterpret_cast<const void*>(std::size_t{part.first_index} * sizeof(std::uint32_t)));
  }
  return {};
}

}  // namespace sim

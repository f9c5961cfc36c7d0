#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "render/frustum.h"
#include "render/gl.h"
#include "render/gpu_store.h"
#include "render/lights.h"
#include "render/shadow_map.h"
#include "render/surface_pass.h"

namespace sim {
namespace {

constexpr float least_seen = 0.02F;  // opacity of what has a mark

}  // namespace

class Renderer::Impl {
 public:
  explicit Impl(std::unique_ptr<gl::Context> context)
      : context_(std::move(context)), gl_(context_->functions()), store_(gl_), shadow_(gl_, store_), surfaces_(gl_, store_, shadow_) {}
  ~Impl() { context_->make_current(); }

  base::Result<void> prepare();
  base::Result<void> draw(const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses, const View& view,
                          const Overlay* overlay);
  void read_rgba(std::span<std::uint8_t> out);
  void read_depth(std::span<float> out);
  Statistics statistics() const {
    Statistics out = statistics_;
    out.shadow_rebuilds = shadow_.rebuilds();
    out.moving_shadows = shadow_.moving_drawn();
    return out;
  }

 private:
  base::Result<void> check(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const View& view) const;
  void resize(int width, int height);
  void choose(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const View& view);
  ShadowView shadow_view(std::span<const Eigen::Isometry3d> poses, const View& view) const;
  base::Result<void> draw_transparent(std::span<const Item> items);
  void draw_sky(const Scene& scene, const View& view, const Lights& lights);
  void draw_triangles(const std::vector<OverlayVertex>& triangles, const Eigen::Matrix4f& matrix, bool is_depth_tested);

  std::unique_ptr<gl::Context> context_;
  const gl::Functions& gl_;
  GpuStore store_;
  ShadowMap shadow_;
  SurfacePass surfaces_;
  gl::Object framebuffer_, color_, depth_;
  gl::Object screen_array_, screen_vertices_, overlay_array_, overlay_vertices_;
  std::optional<GpuProgram> sky_, overlay_;
  int width_ = 0, height_ = 0, largest_ = 0;
  View view_;
  std::shared_ptr<const Scene> scene_;
  Eigen::Matrix4d projection_ = Eigen::Matrix4d::Identity();
  std::vector<Item> items_;
  Statistics statistics_;
};

base::Result<void> Renderer::Impl::prepare() {
  gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
  gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
  gl_.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest_);
  auto sky = GpuProgram::build(gl_, sky_vertex_source(), sky_fragment_source());
  if (!sky) return sky.error();
  sky_.emplace(std::move(*sky));
  auto overlay = GpuProgram::build(gl_, overlay_vertex_source(), overlay_fragment_source());
  if (!overlay) return overlay.error();
  overlay_.emplace(std::move(*overlay));

  screen_array_ = gl::Object(gl_.GenVertexArrays, gl_.DeleteVertexArrays);
  screen_vertices_ = gl::Object(gl_.GenBuffers, gl_.DeleteBuffers);
  gl_.BindVertexArray(screen_array_.name());
  gl_.BindBuffer(GL_ARRAY_BUFFER, screen_vertices_.name());
  const float corners[] = {-1, -1, 0, 3, -1, 0, -1, 3, 0};
  gl_.BufferData(GL_ARRAY_BUFFER, sizeof corners, corners, GL_STATIC_DRAW);
  gl_.EnableVertexAttribArray(0);
  gl_.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);

  overlay_array_ = gl::Object(gl_.GenVertexArrays, gl_.DeleteVertexArrays);
  overlay_vertices_ = gl::Object(gl_.GenBuffers, gl_.DeleteBuffers);
  gl_.BindVertexArray(overlay_array_.name());
  gl_.BindBuffer(GL_ARRAY_BUFFER, overlay_vertices_.name());
  gl_.EnableVertexAttribArray(0);
  gl_.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(OverlayVertex), nullptr);
  gl_.EnableVertexAttribArray(1);
  gl_.VertexAttribPointer(1, 4, GL_FLOAT, GL_FALSE, sizeof(OverlayVertex), reinterpret_cast<const void*>(sizeof(float) * 3));
  return {};
}

base::Result<void> Renderer::Impl::check(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const View& view) const {
  const auto bad = [](const std::string& what) { return base::Error{"render: " + what}; };
  if (view.width < 1 || view.height < 1 || view.width > largest_ || view.height > largest_)
    return bad("picture of " + std::to_string(view.width) + "x" + std::to_string(view.height) + " pixels (expected 1.." +
               std::to_string(largest_) + ")");
  if (poses.size() != scene.links.size())
    return bad(std::to_string(poses.size()) + " poses for " + std::to_string(scene.links.size()) + " links");
  const bool is_frustum = view.right > view.left && view.top > view.bottom && view.far_clip > view.near_clip &&
                          (view.is_parallel || view.near_clip > 0) && std::isfinite(view.far_clip - view.near_clip) &&
                          std::isfinite(view.right - view.left) && std::isfinite(view.top - view.bottom);
  if (!is_frustum) return bad("clip planes or field of view make no frustum");
  if (!view.pose.matrix().allFinite()) return bad("the pose of the camera is not finite");
  if (view.shadow_size > 8192) return bad("shadow map of " + std::to_string(view.shadow_size) + " pixels (expected 0..8192)");
  return {};
}

void Renderer::Impl::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  framebuffer_ = gl::Object(gl_.GenFramebuffers, gl_.DeleteFramebuffers);
  color_ = gl::Object(gl_.GenRenderbuffers, gl_.DeleteRenderbuffers);
  depth_ = gl::Object(gl_.GenRenderbuffers, gl_.DeleteRenderbuffers);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  gl_.BindRenderbuffer(GL_RENDERBUFFER, color_.name());
  gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_.name());
  gl_.BindRenderbuffer(GL_RENDERBUFFER, depth_.name());
  gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
  gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_.name());
  width_ = width;
  height_ = height;
}

// Opaque things from near to far so that what is hidden is not shaded, grounds after them, transparent things from far to near.
void Renderer::Impl::choose(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const View& view) {
  const auto planes = frustum_planes(projection_);
  const Eigen::Vector3d eye = view.pose.translation();
  items_.clear();
  statistics_.culled = 0;
  for (const auto& drawable : scene.drawables) {
    if ((drawable.visibility_flags & view.visibility_mask) == 0) continue;
    if (view.wants_marks && drawable.material.albedo.w() < least_seen) continue;
    const Eigen::Isometry3d& pose = poses[drawable.link];
    const Eigen::Vector3d centre = pose * drawable.centre - eye;
    const bool is_outside = std::any_of(planes.begin(), planes.end(), [&](const Eigen::Vector4d& plane) {
      return plane.head<3>().dot(centre) + plane.w() < -drawable.radius;
    });
    if (is_outside) {
      ++statistics_.culled;
      continue;
    }
    Item item{&drawable, centre.norm() - drawable.radius, (pose * drawable.in_link).matrix()};
    item.model.topRightCorner<3, 1>() -= eye;
    // Finer than its sphere: a camera hangs within that of what carries it.
    if (is_box_outside(drawable.bounds(), item.model, planes)) {
      ++statistics_.culled;
      continue;
    }
    items_.push_back(item);
  }
  const auto group = [](const Item& item) { return item.drawable->material.is_transparent ? 2 : item.drawable->is_ground ? 1 : 0; };
  std::stable_sort(items_.begin(), items_.end(), [&](const Item& a, const Item& b) {
    if (group(a) != group(b)) return group(a) < group(b);
    return group(a) == 2 ? a.distance > b.distance : a.distance < b.distance;
  });
  statistics_.drawn = items_.size();
}

// Of the things that have been chosen.
ShadowView Renderer::Impl::shadow_view(std::span<const Eigen::Isometry3d> poses, const View& view) const {
  ShadowView out;
  out.eye = view.pose.translation();
  out.focus = out.eye + 20 * view.pose.linear().col(0);
  out.planes = frustum_planes(projection_);
  out.floor = std::numeric_limits<double>::infinity();
  out.ceiling = -out.floor;
  for (const auto& item : items_) {
    const Eigen::AlignedBox3d box = item.drawable->bounds_at(poses[item.drawable->link]);
    out.floor = std::min(out.floor, box.min().z());
    out.ceiling = std::max(out.ceiling, box.max().z());
  }
  return out;
}

base::Result<void> Renderer::Impl::draw_transparent(std::span<const Item> items) {
  if (items.empty()) return {};
  surfaces_.resume();
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  gl_.DepthMask(GL_FALSE);
  for (const auto& item : items) {
    if (auto done = surfaces_.draw(item); !done) return done;
  }
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
  return {};
}

void Renderer::Impl::draw_sky(const Scene& scene, const View& view, const Lights& lights) {
  const SkyColors colors = sky_colors(*scene.look.sky);
  const auto set = [&](const char* name, const Eigen::Vector3f& value) { gl_.Uniform3fv(sky_->uniform(name), 1, value.data()); };
  gl_.UseProgram(sky_->name());
  const double half_width = 0.5 * (view.right - view.left), half_height = 0.5 * (view.top - view.bottom);
  // Parallel views see one and the same spot of the sky.
  const double spread = view.is_parallel ? 0 : 1;
  set("forward", view.pose.linear().col(0).cast<float>());
  set("right", (-spread * half_width * view.pose.linear().col(1)).cast<float>());
  set("up", (spread * half_height * view.pose.linear().col(2)).cast<float>());
  gl_.Uniform2f(sky_->uniform("middle"), static_cast<float>(0.5 * (view.right + view.left) / half_width),
                static_cast<float>(0.5 * (view.top + view.bottom) / half_height));
  set("zenith", colors.zenith);
  set("horizon", colors.horizon);
  // Ground ends somewhere; beyond there is haze.
  set("ground", scene.look.fog ? linear(scene.look.fog->color) : colors.ground);
  set("sun_glow", lights.suns.empty() ? Eigen::Vector3f::Zero() : colors.glow);
  set("sun_direction", lights.suns.empty() ? Eigen::Vector3f::UnitZ() : lights.suns.front().to_light);
  gl_.Disable(GL_CULL_FACE);
  gl_.DepthMask(GL_FALSE);
  gl_.BindVertexArray(screen_array_.name());
  gl_.DrawArrays(GL_TRIANGLES, 0, 3);
  gl_.DepthMask(GL_TRUE);
}

void Renderer::Impl::draw_triangles(const std::vector<OverlayVertex>& triangles, const Eigen::Matrix4f& matrix, bool is_depth_tested) {
  if (triangles.empty()) return;
  gl_.UseProgram(overlay_->name());
  gl_.UniformMatrix4fv(overlay_->uniform("view_projection"), 1, GL_FALSE, matrix.data());
  gl_.BindVertexArray(overlay_array_.name());
  gl_.BindBuffer(GL_ARRAY_BUFFER, overlay_vertices_.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(triangles.size() * sizeof(OverlayVertex)), triangles.data(), GL_STREAM_DRAW);
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  gl_.Disable(GL_CULL_FACE);
  if (!is_depth_tested) gl_.Disable(GL_DEPTH_TEST);
  gl_.DepthMask(GL_FALSE);
  gl_.DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(triangles.size()));
  gl_.DepthMask(GL_TRUE);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.Disable(GL_BLEND);
}

base::Result<void> Renderer::Impl::draw(const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses,
                                        const View& view, const Overlay* overlay) {
  if (auto checked = check(*scene, poses, view); !checked) return checked;
  if (!context_->make_current()) return base::Error{"render: OSMesa cannot make its own context current"};
  if (scene_ != scene) {
    store_.enter(*scene);
    shadow_.forget();
    scene_ = scene;
  }
  store_.begin(poses);
  view_ = view;
  ++statistics_.draws;
  projection_ = view_projection(view);
  choose(*scene, poses, view);
  const bool has_light = view.wants_color && !view.wants_marks;
  const Lights lights = has_light ? collect_lights(*scene, poses, view) : Lights{};
  if (lights.has_shadow) {
    if (auto done = shadow_.update(*scene, poses, lights.to_shadow_light, shadow_view(poses, view), view.shadow_size); !done) return done;
    gl_.ActiveTexture(GL_TEXTURE2);
    gl_.BindTexture(GL_TEXTURE_2D, shadow_.texture());
  }

  resize(view.width, view.height);
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  gl_.DrawBuffer(GL_COLOR_ATTACHMENT0);
  gl_.ReadBuffer(GL_COLOR_ATTACHMENT0);
  gl_.Viewport(0, 0, view.width, view.height);
  const GLboolean has_color = view.wants_color ? GL_TRUE : GL_FALSE;
  gl_.ColorMask(has_color, has_color, has_color, has_color);
  gl_.DepthMask(GL_TRUE);
  gl_.DepthFunc(GL_LEQUAL);
  gl_.Enable(GL_DEPTH_TEST);
  gl_.Disable(GL_BLEND);
  gl_.CullFace(GL_BACK);
  const Color& background = scene->look.background;
  if (view.wants_marks) {
    gl_.ClearColor(0, 0, 0, 0);
  } else {
    gl_.ClearColor(background.r, background.g, background.b, view.wants_objects ? 0 : 1);
  }
  gl_.Clear(view.wants_color ? GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT : GL_DEPTH_BUFFER_BIT);

  surfaces_.begin({*scene, view_, lights, projection_});
  // What only has depth or a mark has no transparency.
  const auto is_opaque = [&](const Item& item) { return !has_light || !item.drawable->material.is_transparent; };
  const auto count = static_cast<std::size_t>(std::partition_point(items_.begin(), items_.end(), is_opaque) - items_.begin());
  for (const auto& item : std::span(items_).first(count)) {
    if (auto done = surfaces_.draw(item); !done) return done;
  }
  if (!has_light) return {};
  if (view.wants_objects) gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
  if (scene->look.sky) draw_sky(*scene, view, lights);
  gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  if (auto done = draw_transparent(std::span(items_).subspan(count)); !done) return done;
  if (overlay != nullptr) {
    gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
    draw_triangles(overlay_triangles(*overlay, view, view.pixel_scale), projection_.cast<float>(), true);
    draw_triangles(label_triangles(*overlay, view, view.pixel_scale), Eigen::Matrix4f::Identity(), false);
    gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  return {};
}

void Renderer::Impl::read_rgba(std::span<std::uint8_t> out) {
  if (!context_->make_current() || out.size() < static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) * 4) return;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  gl_.ReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, out.data());
}

void Renderer::Impl::read_depth(std::span<float> out) {
  const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  if (!context_->make_current() || out.size() < count) return;
  gl_.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
  gl_.ReadPixels(0, 0, width_, height_, GL_DEPTH_COMPONENT, GL_FLOAT, out.data());
  // From depth in [0, 1] back to metres: the inverse of view_projection().
  const double n = view_.near_clip, f = view_.far_clip;
  constexpr float nothing = std::numeric_limits<float>::infinity();
  if (view_.is_parallel) {
    const auto start = static_cast<float>(n), length = static_cast<float>(f - n);
    for (std::size_t i = 0; i < count; ++i) out[i] = out[i] >= 1.0F ? nothing : start + length * out[i];
    return;
  }
  const auto top = static_cast<float>(f * n / (f - n)), reach = static_cast<float>(f / (f - n));
  for (std::size_t i = 0; i < count; ++i) {
    const float metres = top / (reach - out[i]);
    out[i] = out[i] >= 1.0F ? nothing : metres;
  }
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;

base::Result<std::unique_ptr<Renderer>> Renderer::open() {
  auto context = gl::Context::open();
  if (!context) return context.error();
  auto impl = std::make_unique<Impl>(std::move(*context));
  if (auto prepared = impl->prepare(); !prepared) return prepared.error();
  return std::unique_ptr<Renderer>(new Renderer(std::move(impl)));
}

base::Result<void> Renderer::draw(const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses, const View& view,
                                  const Overlay* overlay) {
  return impl_->draw(scene, poses, view, overlay);
}
void Renderer::read_rgba(std::span<std::uint8_t> out) { impl_->read_rgba(out); }
void Renderer::read_depth(std::span<float> out) { impl_->read_depth(out); }
Renderer::Statistics Renderer::statistics() const { return impl_->statistics(); }

bool can_show_objects(const Scene& scene) {
  constexpr std::size_t most = 255;
  return scene.objects.size() <= most && std::ranges::none_of(scene.drawables, [](const Drawable& drawable) {
           const Material& material = drawable.material;
           return material.is_transparent || (material.texture && material.texture->has_holes);
         });
}

base::Result<Image> draw_smooth(Renderer& renderer, const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses,
                                View view, const Overlay* overlay) {
  // Very large pictures are fine enough as they are.
  const bool is_doubled = std::max(view.width, view.height) <= 4096;
  if (is_doubled) {
    view.width *= 2;
    view.height *= 2;
    view.pixel_scale = 2;
  }
  view.shadow_size = view.shadow_size > 0 ? 4096 : 0;
  view.shadow_taps = 4;
  if (auto drawn = renderer.draw(scene, poses, view, overlay); !drawn) return drawn.error();
  Image image{view.width, view.height, {}};
  image.rgba.resize(image.size_bytes());
  renderer.read_rgba(image.rgba);
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
  return is_doubled ? halve(image) : std::move(image);
}

}  // namespace sim

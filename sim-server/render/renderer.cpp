#include "render/renderer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "render/gl.h"
#include "render/gpu_store.h"
#include "render/shadow_map.h"

namespace sim {
namespace {

constexpr int most_lamps = 8;  // point and spot lights that are used in one picture: the strongest at the camera's place

Eigen::Vector3f linear(const Color& color) { return {to_linear(color.r), to_linear(color.g), to_linear(color.b)}; }
// Lights are linear already.
Eigen::Vector3f radiance(const Color& color, double intensity) {
  return Eigen::Vector3f(color.r, color.g, color.b) * static_cast<float>(intensity);
}

// From world axes relative to the camera to clip coordinates; y is turned down so that rows come out from the top.
Eigen::Matrix4d view_projection(const View& view) {
  Eigen::Matrix4d turn = Eigen::Matrix4d::Identity();
  turn.block<1, 3>(0, 0) = -view.pose.linear().col(1).transpose();
  turn.block<1, 3>(1, 0) = view.pose.linear().col(2).transpose();
  turn.block<1, 3>(2, 0) = view.pose.linear().col(0).transpose();  // depth, positive ahead
  Eigen::Matrix4d project = Eigen::Matrix4d::Zero();
  const double width = view.right - view.left, height = view.top - view.bottom, n = view.near_clip, f = view.far_clip;
  project(0, 0) = 2 / width;
  project(1, 1) = -2 / height;
  const double dx = (view.right + view.left) / width, dy = (view.top + view.bottom) / height;
  if (view.is_parallel) {
    project(0, 3) = -dx;
    project(1, 3) = dy;
    project(2, 2) = 2 / (f - n);
    project(2, 3) = -(f + n) / (f - n);
    project(3, 3) = 1;
  } else {
    project(0, 2) = -dx;
    project(1, 2) = dy;
    project(2, 2) = (f + n) / (f - n);
    project(2, 3) = -2 * f * n / (f - n);
    project(3, 2) = 1;
  }
  return project * turn;
}

// The six planes of a frustum, pointing inwards, of unit normals; for points relative to the camera.
std::array<Eigen::Vector4d, 6> frustum_planes(const Eigen::Matrix4d& m) {
  std::array<Eigen::Vector4d, 6> planes;
  for (int i = 0; i < 3; ++i) {
    planes[static_cast<std::size_t>(2 * i)] = m.row(3) + m.row(i);
    planes[static_cast<std::size_t>(2 * i + 1)] = m.row(3) - m.row(i);
  }
  for (auto& plane : planes) plane /= plane.head<3>().norm();
  return planes;
}

struct Sun {
  Eigen::Vector3f to_light, color, specular;
};
struct Lamp {
  Eigen::Vector3f position, color, specular;
  Eigen::Vector4f reach;
  bool is_spot = false;
  Eigen::Vector3f axis, cone;
  double strength = 0;  // to choose by
};

struct Lights {
  std::vector<Sun> suns;  // the one with the shadow first
  bool has_shadow = false;
  Eigen::Vector3d to_shadow_light{0, 0, 1};
  std::vector<Lamp> lamps;  // points, then spots
  int points = 0, spots = 0;
};

Lamp make_lamp(const LightDef& light, const Eigen::Isometry3d& pose, const Eigen::Vector3d& eye) {
  Lamp lamp;
  lamp.position = (pose.translation() - eye).cast<float>();
  lamp.color = radiance(light.diffuse, light.intensity);
  lamp.specular = radiance(light.specular, light.intensity);
  lamp.reach =
      Eigen::Vector4d(light.constant_attenuation, light.linear_attenuation, light.quadratic_attenuation, light.range).cast<float>();
  lamp.is_spot = light.kind == LightDef::Kind::spot;
  lamp.axis = (pose.linear() * light.direction).cast<float>();
  const double outer = std::cos(0.5 * light.outer_angle), inner = std::cos(0.5 * light.inner_angle);
  lamp.cone = Eigen::Vector3d(outer, 1 / std::max(inner - outer, 1e-4), light.falloff).cast<float>();
  lamp.strength = static_cast<double>(lamp.color.sum()) * light.range / (1 + lamp.position.cast<double>().norm());
  return lamp;
}

Lights collect_lights(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const View& view) {
  Lights out;
  for (const auto& [light, link] : scene.lights) {
    if (!light.is_on) continue;
    const Eigen::Isometry3d pose = link < 0 ? light.pose : poses[static_cast<std::size_t>(link)] * light.pose;
    if (light.kind != LightDef::Kind::directional) {
      out.lamps.push_back(make_lamp(light, pose, view.pose.translation()));
      continue;
    }
    const Eigen::Vector3d to_light = -(pose.linear() * light.direction);
    const Sun sun{to_light.cast<float>(), radiance(light.diffuse, light.intensity), radiance(light.specular, light.intensity)};
    const bool is_first_shadow = light.cast_shadows && scene.look.shadows && view.shadow_size > 0 && !out.has_shadow;
    if (is_first_shadow) out.to_shadow_light = to_light;
    out.has_shadow = out.has_shadow || is_first_shadow;
    out.suns.insert(is_first_shadow ? out.suns.begin() : out.suns.end(), sun);
  }
  std::stable_sort(out.lamps.begin(), out.lamps.end(), [](const Lamp& a, const Lamp& b) { return a.strength > b.strength; });
  if (out.lamps.size() > most_lamps) out.lamps.resize(most_lamps);
  std::stable_partition(out.lamps.begin(), out.lamps.end(), [](const Lamp& lamp) { return !lamp.is_spot; });
  for (const auto& lamp : out.lamps) ++(lamp.is_spot ? out.spots : out.points);
  return out;
}

struct SkyColors {
  Eigen::Vector3f zenith, horizon, ground, glow;
};

// Day, dusk and night by the hour of the scene.
SkyColors sky_colors(const SkyDef& sky) {
  const SkyColors day{{0.075F, 0.22F, 0.56F}, {0.52F, 0.69F, 0.87F}, {0.34F, 0.37F, 0.38F}, {1.0F, 0.9F, 0.7F}};
  const SkyColors dusk{{0.06F, 0.09F, 0.25F}, {0.75F, 0.36F, 0.16F}, {0.13F, 0.11F, 0.11F}, {1.0F, 0.5F, 0.2F}};
  const SkyColors night{{0.002F, 0.004F, 0.012F}, {0.008F, 0.012F, 0.03F}, {0.004F, 0.005F, 0.006F}, {0.05F, 0.05F, 0.06F}};
  const double edge = std::min(std::abs(sky.time - sky.sunrise), std::abs(sky.time - sky.sunset));
  const bool is_day = sky.time > sky.sunrise && sky.time < sky.sunset;
  const auto share = static_cast<float>(std::clamp(edge / 1.5, 0.0, 1.0));
  const SkyColors& full = is_day ? day : night;
  const auto mix = [&](const Eigen::Vector3f& a, const Eigen::Vector3f& b) { return Eigen::Vector3f(a + (b - a) * share); };
  return {mix(dusk.zenith, full.zenith), mix(dusk.horizon, full.horizon), mix(dusk.ground, full.ground), mix(dusk.glow, full.glow)};
}

}  // namespace

View View::pinhole(const Eigen::Isometry3d& pose, double horizontal_fov, int width, int height) {
  View view;
  view.pose = pose;
  view.width = width;
  view.height = height;
  view.right = std::tan(0.5 * horizontal_fov);
  view.left = -view.right;
  view.top = view.right * height / width;
  view.bottom = -view.top;
  return view;
}

class Renderer::Impl {
 public:
  explicit Impl(std::unique_ptr<gl::Context> context)
      : context_(std::move(context)), gl_(context_->functions()), store_(gl_), shadow_(gl_, store_) {}
  ~Impl() { context_->make_current(); }

  base::Result<void> prepare();
  base::Result<void> draw(const std::shared_ptr<const Scene>& scene, std::span<const Eigen::Isometry3d> poses, const View& view,
                          const Overlay* overlay);
  void read_rgba(std::span<std::uint8_t> out);
  void read_depth(std::span<float> out);
  Statistics statistics() const {
    Statistics out = statistics_;
    out.shadow_rebuilds = shadow_.rebuilds();
    return out;
  }

 private:
  // One drawable of the picture, in the order of drawing.
  struct Item {
    const Drawable* drawable;
    double distance;
    Eigen::Matrix4d model;  // relative to the camera
  };
  base::Result<void> check(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const View& view) const;
  void resize(int width, int height);
  void choose(const Scene& scene, std::span<const Eigen::Isometry3d> poses, const View& view);
  base::Result<void> draw_item(const Item& item, const Scene& scene, const View& view, const Lights& lights);
  Features features_of(const Drawable& drawable, const Scene& scene, const View& view, const Lights& lights) const;
  void tell_view(const SurfaceProgram& program, const Scene& scene, const View& view, const Lights& lights);
  void tell_lights(const SurfaceProgram& program, const Lights& lights);
  void tell_material(const SurfaceProgram& program, const Material& material);
  void draw_sky(const Scene& scene, const View& view, const Lights& lights);
  void draw_triangles(const std::vector<OverlayVertex>& triangles, const Eigen::Matrix4f& matrix, bool is_depth_tested);

  std::unique_ptr<gl::Context> context_;
  const gl::Functions& gl_;
  GpuStore store_;
  ShadowMap shadow_;
  gl::Object framebuffer_, color_, depth_;
  gl::Object screen_array_, screen_vertices_, overlay_array_, overlay_vertices_;
  std::optional<GpuProgram> sky_, overlay_;
  int width_ = 0, height_ = 0, largest_ = 0;
  View view_;
  std::shared_ptr<const Scene> scene_;
  Eigen::Matrix4d projection_ = Eigen::Matrix4d::Identity();
  std::vector<Item> items_;
  const SurfaceProgram* current_ = nullptr;
  const Material* told_material_ = nullptr;
  std::uint64_t frame_ = 0;
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
    items_.push_back(item);
  }
  const auto group = [](const Item& item) { return item.drawable->material.is_transparent ? 2 : item.drawable->is_ground ? 1 : 0; };
  std::stable_sort(items_.begin(), items_.end(), [&](const Item& a, const Item& b) {
    if (group(a) != group(b)) return group(a) < group(b);
    return group(a) == 2 ? a.distance > b.distance : a.distance < b.distance;
  });
  statistics_.drawn = items_.size();
}

Features Renderer::Impl::features_of(const Drawable& drawable, const Scene& scene, const View& view, const Lights& lights) const {
  const Material& material = drawable.material;
  Features f;
  f.holes = material.texture && material.texture->has_holes;
  if (!view.wants_color) {
    f.depth_only = true;
    f.texture = f.holes;
    return f;
  }
  f.texture = material.texture != nullptr;
  f.lit = material.is_lit;
  f.grid = view.grid && drawable.is_ground;
  if (scene.look.fog)
    f.fog = scene.look.fog->type == "linear"      ? FogKind::linear
            : scene.look.fog->type == "quadratic" ? FogKind::quadratic
                                                  : FogKind::exponential;
  if (!f.lit) return f;
  f.normal_map = f.texture && material.normal_map != nullptr;
  f.specular = material.specular.maxCoeff() > 0;
  f.double_sided = material.is_double_sided;
  f.shadow_taps = lights.has_shadow ? std::max(1, view.shadow_taps) : 0;
  f.directional = static_cast<int>(lights.suns.size());
  f.points = lights.points;
  f.spots = lights.spots;
  return f;
}

void Renderer::Impl::tell_lights(const SurfaceProgram& program, const Lights& lights) {
  std::vector<float> a, b, c, d, e, f;
  const auto append = [](std::vector<float>& to, const auto& v) { to.insert(to.end(), v.data(), v.data() + v.size()); };
  for (const auto& sun : lights.suns) append(a, sun.to_light), append(b, sun.color), append(c, sun.specular);
  const auto suns = static_cast<GLsizei>(lights.suns.size());
  if (suns > 0) {
    gl_.Uniform3fv(program.sun_direction, suns, a.data());
    gl_.Uniform3fv(program.sun_color, suns, b.data());
    gl_.Uniform3fv(program.sun_specular, suns, c.data());
  }
  if (lights.lamps.empty()) return;
  for (auto* list : {&a, &b, &c}) list->clear();
  std::vector<float> reach;
  for (const auto& lamp : lights.lamps) {
    append(a, lamp.position), append(b, lamp.color), append(c, lamp.specular), append(reach, lamp.reach);
    if (lamp.is_spot) append(d, lamp.axis), append(e, lamp.cone);
  }
  const auto lamps = static_cast<GLsizei>(lights.lamps.size());
  gl_.Uniform3fv(program.lamp_position, lamps, a.data());
  gl_.Uniform3fv(program.lamp_color, lamps, b.data());
  gl_.Uniform3fv(program.lamp_specular, lamps, c.data());
  gl_.Uniform4fv(program.lamp_reach, lamps, reach.data());
  if (lights.spots > 0) {
    gl_.Uniform3fv(program.spot_axis, lights.spots, d.data());
    gl_.Uniform3fv(program.spot_cone, lights.spots, e.data());
  }
}

void Renderer::Impl::tell_view(const SurfaceProgram& program, const Scene& scene, const View& view, const Lights& lights) {
  const Eigen::Matrix4f projection = projection_.cast<float>();
  gl_.UniformMatrix4fv(program.view_projection, 1, GL_FALSE, projection.data());
  if (!view.wants_color) return;
  const Eigen::Vector3f ambient = linear(scene.look.ambient);
  gl_.Uniform3fv(program.ambient, 1, ambient.data());
  const Eigen::Vector3f eye = view.pose.translation().cast<float>();
  gl_.Uniform3fv(program.eye, 1, eye.data());
  if (scene.look.fog) {
    const FogDef& fog = *scene.look.fog;
    const Eigen::Vector3f color = linear(fog.color);
    gl_.Uniform4f(program.fog_color, color.x(), color.y(), color.z(), static_cast<float>(fog.density));
    gl_.Uniform2f(program.fog_range, static_cast<float>(fog.start), static_cast<float>(1 / std::max(fog.end - fog.start, 1e-6)));
  }
  tell_lights(program, lights);
  if (!lights.has_shadow) return;
  Eigen::Matrix4d from_eye = Eigen::Matrix4d::Identity();
  from_eye.topRightCorner<3, 1>() = view.pose.translation();
  const Eigen::Matrix4f shadow = (shadow_.matrix() * from_eye).cast<float>();
  gl_.UniformMatrix4fv(program.shadow_matrix, 1, GL_FALSE, shadow.data());
  const double taps = std::max(1, view.shadow_taps);
  gl_.Uniform1f(program.shadow_lift, static_cast<float>((1.0 + 0.5 * taps) * shadow_.texel()));
  gl_.Uniform1f(program.shadow_texel, 1.0F / static_cast<float>(shadow_.size()));
  gl_.Uniform1i(program.shadow_map, 2);
}

void Renderer::Impl::tell_material(const SurfaceProgram& program, const Material& material) {
  if (told_material_ == &material) return;
  told_material_ = &material;
  if (material.texture && program.albedo_map >= 0) {
    gl_.ActiveTexture(GL_TEXTURE0);
    gl_.BindTexture(GL_TEXTURE_2D, store_.texture(material.texture));
    gl_.Uniform1i(program.albedo_map, 0);
    gl_.Uniform2f(program.repeat, material.repeat.x(), material.repeat.y());
  }
  if (material.normal_map && program.bump_map >= 0) {
    gl_.ActiveTexture(GL_TEXTURE1);
    gl_.BindTexture(GL_TEXTURE_2D, store_.texture(material.normal_map));
    gl_.Uniform1i(program.bump_map, 1);
  }
  gl_.Uniform4fv(program.albedo, 1, material.albedo.data());
  gl_.Uniform3fv(program.emissive, 1, material.emissive.data());
  gl_.Uniform4f(program.shine, material.specular.x(), material.specular.y(), material.specular.z(), material.shininess);
}

base::Result<void> Renderer::Impl::draw_item(const Item& item, const Scene& scene, const View& view, const Lights& lights) {
  const Drawable& drawable = *item.drawable;
  auto program = store_.program(features_of(drawable, scene, view, lights));
  if (!program) return program.error();
  if (*program != current_) {
    current_ = *program;
    told_material_ = nullptr;
    gl_.UseProgram(current_->program.name());
    if ((*program)->frame != frame_) tell_view(*current_, scene, view, lights);
    (*program)->frame = frame_;
  }
  tell_material(*current_, drawable.material);
  const Eigen::Matrix4f model = item.model.cast<float>();
  gl_.UniformMatrix4fv(current_->model, 1, GL_FALSE, model.data());
  if (current_->normal_matrix >= 0) {
    const Eigen::Matrix3f normals = item.model.topLeftCorner<3, 3>().inverse().transpose().cast<float>();
    gl_.UniformMatrix3fv(current_->normal_matrix, 1, GL_FALSE, normals.data());
  }
  if (drawable.material.is_double_sided) {
    gl_.Disable(GL_CULL_FACE);
  } else {
    gl_.Enable(GL_CULL_FACE);
  }
  // The picture is upside down for GL, which turns every winding round.
  gl_.FrontFace(drawable.is_mirrored ? GL_CCW : GL_CW);
  const MeshPart& part = drawable.mesh->parts[drawable.part];
  gl_.BindVertexArray(store_.mesh(drawable.mesh).vertex_array.name());
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.index_count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(std::size_t{part.first_index} * sizeof(std::uint32_t)));
  return {};
}

void Renderer::Impl::draw_sky(const Scene& scene, const View& view, const Lights& lights) {
  const SkyColors colors = sky_colors(*scene.look.sky);
  const auto set = [&](const char* name, const Eigen::Vector3f& value) { gl_.Uniform3fv(sky_->uniform(name), 1, value.data()); };
  gl_.UseProgram(sky_->name());
  current_ = nullptr;
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
  set("ground", colors.ground);
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
  current_ = nullptr;
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
  if (!context_->make_current()) return base::Error{"render: OSMesa refuses its own context"};
  if (scene_ != scene) {
    store_.keep_only(*scene);
    shadow_.forget();
    scene_ = scene;
  }
  view_ = view;
  ++frame_;
  ++statistics_.draws;
  projection_ = view_projection(view);
  current_ = nullptr;
  told_material_ = nullptr;
  const Lights lights = view.wants_color ? collect_lights(*scene, poses, view) : Lights{};
  if (lights.has_shadow) {
    const Eigen::Vector3d focus = view.pose.translation() + 20 * view.pose.linear().col(0);
    if (auto done = shadow_.update(*scene, poses, lights.to_shadow_light, focus, view.shadow_size); !done) return done;
    gl_.ActiveTexture(GL_TEXTURE2);
    gl_.BindTexture(GL_TEXTURE_2D, shadow_.texture());
  }
  choose(*scene, poses, view);

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
  gl_.ClearColor(background.r, background.g, background.b, 1);
  gl_.Clear(view.wants_color ? GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT : GL_DEPTH_BUFFER_BIT);

  auto item = items_.begin();
  for (; item != items_.end() && (!item->drawable->material.is_transparent || !view.wants_color); ++item) {
    if (auto done = draw_item(*item, *scene, view, lights); !done) return done;
  }
  if (!view.wants_color) return {};
  if (scene->look.sky) draw_sky(*scene, view, lights);
  if (item != items_.end()) {
    gl_.Enable(GL_BLEND);
    gl_.BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_FALSE);
    gl_.DepthMask(GL_FALSE);
    for (; item != items_.end(); ++item) {
      if (auto done = draw_item(*item, *scene, view, lights); !done) return done;
    }
    gl_.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl_.DepthMask(GL_TRUE);
    gl_.Disable(GL_BLEND);
  }
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

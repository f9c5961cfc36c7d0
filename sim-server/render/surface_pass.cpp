#include "render/surface_pass.h"

#include <algorithm>
#include <cmath>

namespace sim {
namespace {

Features features_of(const Drawable& drawable, const Picture& picture) {
  const auto& [scene, view, lights, projection] = picture;
  const Material& material = drawable.material;
  Features f;
  f.holes = material.texture && material.texture->has_holes;
  if (view.wants_exact_depth && !view.is_parallel && !material.is_double_sided) f.round = drawable.mesh->round.kind;
  if (!view.wants_color) {
    f.depth_only = true;
    f.texture = f.holes;
    return f;
  }
  f.texture = material.texture != nullptr;
  f.emissive_map = f.texture && material.emissive_map != nullptr;
  f.lit = material.is_lit;
  f.grid = view.grid && drawable.has_grid;
  if (scene.look.fog)
    f.fog = scene.look.fog->type == "linear"      ? FogKind::linear
            : scene.look.fog->type == "quadratic" ? FogKind::quadratic
                                                  : FogKind::exponential;
  if (!f.lit) return f;
  f.normal_map = f.texture && material.normal_map != nullptr;
  f.specular = material.specular.maxCoeff() > 0;
  const bool is_whole = material.shininess == std::round(material.shininess) && material.shininess <= 128;
  if (f.specular && is_whole) f.shine = static_cast<int>(material.shininess);
  f.faceted = drawable.mesh->parts[drawable.part].is_faceted;
  f.double_sided = material.is_double_sided;
  f.shadow_taps = lights.has_shadow ? std::max(1, view.shadow_taps) : 0;
  f.directional = static_cast<int>(lights.suns.size());
  f.points = lights.points;
  f.spots = lights.spots;
  return f;
}

}  // namespace

void SurfacePass::begin(const Picture& picture) {
  picture_.emplace(picture);
  ++frame_;
  current_ = nullptr;
  told_material_ = nullptr;
}

void SurfacePass::tell_lights(const SurfaceProgram& program) {
  const Lights& lights = picture_->lights;
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

void SurfacePass::tell_view(const SurfaceProgram& program) {
  const auto& [scene, view, lights, view_projection] = *picture_;
  const Eigen::Matrix4f projection = view_projection.cast<float>();
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
  tell_lights(program);
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

void SurfacePass::tell_material(const SurfaceProgram& program, const Material& material) {
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
  if (material.emissive_map && program.glow_map >= 0) {
    gl_.ActiveTexture(GL_TEXTURE3);
    gl_.BindTexture(GL_TEXTURE_2D, store_.texture(material.emissive_map));
    gl_.Uniform1i(program.glow_map, 3);
  }
  gl_.Uniform4fv(program.albedo, 1, material.albedo.data());
  gl_.Uniform3fv(program.emissive, 1, material.emissive.data());
  gl_.Uniform4f(program.shine, material.specular.x(), material.specular.y(), material.specular.z(), material.shininess);
}

base::Result<void> SurfacePass::draw(const Item& item) {
  const Drawable& drawable = *item.drawable;
  auto program = store_.program(features_of(drawable, *picture_));
  if (!program) return program.error();
  if (*program != current_) {
    current_ = *program;
    told_material_ = nullptr;
    gl_.UseProgram(current_->program.name());
    if (current_->frame != frame_) tell_view(*current_);
    current_->frame = frame_;
  }
  tell_material(*current_, drawable.material);
  const Eigen::Matrix4f model = item.model.cast<float>();
  gl_.UniformMatrix4fv(current_->model, 1, GL_FALSE, model.data());
  if (current_->normal_matrix >= 0) {
    const Eigen::Matrix3f normals = item.model.topLeftCorner<3, 3>().inverse().transpose().cast<float>();
    gl_.UniformMatrix3fv(current_->normal_matrix, 1, GL_FALSE, normals.data());
  }
  if (current_->round_eye >= 0) {
    const RoundShape& round = drawable.mesh->round;
    gl_.Uniform2f(current_->round_size, round.radius, round.half_length);
    const Eigen::Vector3f eye = item.model.inverse().topRightCorner<3, 1>().cast<float>();
    gl_.Uniform3fv(current_->round_eye, 1, eye.data());
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

}  // namespace sim

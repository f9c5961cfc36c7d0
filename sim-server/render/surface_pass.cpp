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
  if (view.wants_marks) {
    f.marks = true;
    f.lit = false;
    f.signature = scene.visuals[drawable.visual].signature != nullptr;
    f.holes = f.holes && !f.signature;
    f.texture = f.holes || f.signature;
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

void append_to(std::vector<float>& to, const auto& v) { to.insert(to.end(), v.data(), v.data() + v.size()); }

}  // namespace

void SurfacePass::begin(const Picture& picture) {
  picture_.emplace(picture);
  ++frame_;
  current_ = nullptr;
  told_material_ = nullptr;
}

void SurfacePass::tell_suns(const SurfaceProgram& program) {
  const auto& suns = picture_->lights.suns;
  if (suns.empty()) return;
  std::vector<float> to_light, color, specular;
  for (const auto& sun : suns) append_to(to_light, sun.to_light), append_to(color, sun.color), append_to(specular, sun.specular);
  const auto count = static_cast<GLsizei>(suns.size());
  gl_.Uniform3fv(program.sun_direction, count, to_light.data());
  gl_.Uniform3fv(program.sun_color, count, color.data());
  gl_.Uniform3fv(program.sun_specular, count, specular.data());
}

void SurfacePass::tell_lamps(const SurfaceProgram& program, const std::vector<Lamp>& lamps) {
  if (lamps.empty()) return;
  std::vector<float> position, color, specular, reach, axis, cone;
  for (const auto& lamp : lamps) {
    append_to(position, lamp.position), append_to(color, lamp.color), append_to(specular, lamp.specular), append_to(reach, lamp.reach);
    if (lamp.is_spot) append_to(axis, lamp.axis), append_to(cone, lamp.cone);
  }
  const auto count = static_cast<GLsizei>(lamps.size());
  gl_.Uniform3fv(program.lamp_position, count, position.data());
  gl_.Uniform3fv(program.lamp_color, count, color.data());
  gl_.Uniform3fv(program.lamp_specular, count, specular.data());
  gl_.Uniform4fv(program.lamp_reach, count, reach.data());
  if (axis.empty()) return;
  gl_.Uniform3fv(program.spot_axis, picture_->lights.spots, axis.data());
  gl_.Uniform3fv(program.spot_cone, picture_->lights.spots, cone.data());
}

void SurfacePass::tell_view(const SurfaceProgram& program) {
  const auto& [scene, view, lights, view_projection] = *picture_;
  const Eigen::Matrix4f projection = view_projection.cast<float>();
  gl_.UniformMatrix4fv(program.view_projection, 1, GL_FALSE, projection.data());
  if (!view.wants_color || view.wants_marks) return;
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
  tell_suns(program);
  tell_lamps(program, lights.lamps);
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

void SurfacePass::tell_material(const SurfaceProgram& program, const Drawable& drawable) {
  const Material& material = drawable.material;
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
  Eigen::Vector4f albedo = material.albedo;
  if (picture_->view.wants_objects) albedo.w() = static_cast<float>(picture_->scene.visuals[drawable.visual].object) / 255;
  gl_.Uniform4fv(program.albedo, 1, albedo.data());
  gl_.Uniform3fv(program.emissive, 1, material.emissive.data());
  gl_.Uniform4f(program.shine, material.specular.x(), material.specular.y(), material.specular.z(), material.shininess);
}

// 1 + index of the visual; see render/marks.h.
void SurfacePass::tell_mark(const SurfaceProgram& program, const Drawable& drawable) {
  const std::uint32_t mark = drawable.visual + 1;
  const auto byte = [&](unsigned shift) { return static_cast<float>((mark >> shift) & 255) / 255.0F; };
  gl_.Uniform4f(program.albedo, byte(0), byte(8), byte(16), 0);
  const auto& signature = picture_->scene.visuals[drawable.visual].signature;
  if (!signature) return;
  gl_.ActiveTexture(GL_TEXTURE0);
  gl_.BindTexture(GL_TEXTURE_2D, store_.texture(signature));
  gl_.Uniform1i(program.albedo_map, 0);
  gl_.Uniform2f(program.repeat, 1, 1);
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
  if (!picture_->view.wants_marks || drawable.material.texture) tell_material(*current_, drawable);
  if (picture_->view.wants_marks) tell_mark(*current_, drawable);
  if (const Lights& lights = picture_->lights; !lights.all.empty() && current_->lamp_position >= 0) {
    const Eigen::Vector4d centre = item.model * drawable.bounds().center().homogeneous();
    tell_lamps(*current_, lamps_at(lights, centre.head<3>().cast<float>(), static_cast<float>(drawable.radius)));
  }
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
  // A floor that lies exactly in a larger ground is in front of it everywhere. Depths that are measured stay exact.
  const bool is_pushed = drawable.ground_rank > 0 && picture_->view.wants_color && !picture_->view.wants_exact_depth;
  if (is_pushed) {
    constexpr float units = 16;  // of the depth buffer's resolution, for each rank
    gl_.Enable(GL_POLYGON_OFFSET_FILL);
    gl_.PolygonOffset(0, units * static_cast<float>(drawable.ground_rank));
  }
  const MeshPart& part = drawable.mesh->parts[drawable.part];
  gl_.BindVertexArray(store_.mesh(drawable.mesh).vertex_array.name());
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.index_count), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(std::size_t{part.first_index} * sizeof(std::uint32_t)));
  if (is_pushed) gl_.Disable(GL_POLYGON_OFFSET_FILL);
  return {};
}

}  // namespace sim

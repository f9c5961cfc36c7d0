// The GL objects of a scene in one context: programs, meshes and textures, created when they are first needed. For the thread of the
// context.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "render/gl.h"
#include "render/scene.h"
#include "render/shaders.h"

namespace sim {

class GpuProgram {
 public:
  // The error holds the compiler's words: our sources are constant, so it only happens with a broken driver.
  static base::Result<GpuProgram> build(const gl::Functions& gl, const std::string& vertex, const std::string& fragment);
  ~GpuProgram();
  GpuProgram(GpuProgram&& other) noexcept : gl_(other.gl_), name_(std::exchange(other.name_, 0)) {}
  GpuProgram& operator=(GpuProgram&&) = delete;

  GLuint name() const { return name_; }
  GLint uniform(const char* uniform_name) const { return gl_->GetUniformLocation(name_, uniform_name); }

 private:
  explicit GpuProgram(const gl::Functions& gl) : gl_(&gl), name_(gl.CreateProgram()) {}
  const gl::Functions* gl_;
  GLuint name_ = 0;
};

// A program for surfaces with the places of its uniforms; -1 for those it does not have.
struct SurfaceProgram {
  explicit SurfaceProgram(GpuProgram built);
  GpuProgram program;
  GLint model, normal_matrix, view_projection, repeat, round_size, round_eye;
  GLint albedo, emissive, shine, ambient, fog_color, fog_range, eye;
  GLint sun_direction, sun_color, sun_specular;
  GLint lamp_position, lamp_color, lamp_specular, lamp_reach, spot_axis, spot_cone;
  GLint shadow_map, shadow_matrix, shadow_lift, shadow_texel, albedo_map, bump_map, glow_map;
  std::uint64_t frame = 0;  // of the last picture whose view and lights it was told
};

struct GpuMesh {
  gl::Object vertex_array, vertices, indices;
  std::vector<Eigen::Isometry3d> bones;  // of an actor, relative to it; empty: at rest
  std::uint64_t picture = 0;             // the last one that they were compared in
};

class GpuStore {
 public:
  explicit GpuStore(const gl::Functions& gl) : gl_(gl) {}

  // Of an actor: its vertices are brought to where the bones are in this picture, unless they are there.
  const GpuMesh& mesh(const std::shared_ptr<const Mesh>& mesh);
  GLuint texture(const std::shared_ptr<const Texture>& texture);
  base::Result<SurfaceProgram*> program(const Features& features);

  // From now on meshes and textures are this scene's; those that it does not use are forgotten. It lives until the next one.
  void enter(const Scene& scene);
  // The poses of the links live as long as the picture is drawn.
  void begin(std::span<const Eigen::Isometry3d> poses);

 private:
  GpuMesh& made(const std::shared_ptr<const Mesh>& mesh);
  void bend(GpuMesh& mesh, const SceneActor& actor);

  const gl::Functions& gl_;
  std::map<Features, std::unique_ptr<SurfaceProgram>> programs_;
  std::map<std::shared_ptr<const Mesh>, GpuMesh> meshes_;
  std::map<const Mesh*, const SceneActor*> actors_;  // with a skin, by its mesh
  std::span<const Eigen::Isometry3d> poses_;
  std::uint64_t picture_ = 0;
  std::vector<Vertex> bent_;
  std::map<std::shared_ptr<const Texture>, gl::Object> textures_;
};

}  // namespace sim

#include "render/gpu_store.h"

#include <algorithm>
#include <cstddef>
#include <set>

namespace sim {
namespace {

// An empty text when it compiled.
std::string compile(const gl::Functions& gl, GLuint program, GLenum stage, const std::string& source) {
  const GLuint shader = gl.CreateShader(stage);
  const char* text = source.c_str();
  gl.ShaderSource(shader, 1, &text, nullptr);
  gl.CompileShader(shader);
  GLint is_fine = 0;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &is_fine);
  std::string words;
  if (is_fine == 0) {
    char buffer[1024] = "";
    gl.GetShaderInfoLog(shader, sizeof buffer, nullptr, buffer);
    words = std::string("render: a shader does not compile: ") + buffer;
  } else {
    gl.AttachShader(program, shader);
  }
  gl.DeleteShader(shader);
  return words;
}

}  // namespace

base::Result<GpuProgram> GpuProgram::build(const gl::Functions& gl, const std::string& vertex, const std::string& fragment) {
  GpuProgram program(gl);
  for (const auto& [stage, source] : {std::pair<GLenum, const std::string*>{GL_VERTEX_SHADER, &vertex}, {GL_FRAGMENT_SHADER, &fragment}}) {
    const std::string words = compile(gl, program.name_, stage, *source);
    if (!words.empty()) return base::Error{words};
  }
  gl.LinkProgram(program.name_);
  GLint is_fine = 0;
  gl.GetProgramiv(program.name_, GL_LINK_STATUS, &is_fine);
  if (is_fine != 0) return program;
  char buffer[1024] = "";
  gl.GetProgramInfoLog(program.name_, sizeof buffer, nullptr, buffer);
  return base::Error{std::string("render: a program does not link: ") + buffer};
}

GpuProgram::~GpuProgram() {
  if (name_ != 0) gl_->DeleteProgram(name_);
}

SurfaceProgram::SurfaceProgram(GpuProgram built) : program(std::move(built)) {
  const std::pair<GLint*, const char*> all[] = {{&model, "model"},
                                                {&normal_matrix, "normal_matrix"},
                                                {&view_projection, "view_projection"},
                                                {&repeat, "repeat"},
                                                {&round_size, "round_size"},
                                                {&round_eye, "round_eye"},
                                                {&albedo, "albedo"},
                                                {&emissive, "emissive"},
                                                {&shine, "shine"},
                                                {&ambient, "ambient"},
                                                {&fog_color, "fog_color"},
                                                {&fog_range, "fog_range"},
                                                {&eye, "eye"},
                                                {&sun_direction, "sun_direction"},
                                                {&sun_color, "sun_color"},
                                                {&sun_specular, "sun_specular"},
                                                {&lamp_position, "lamp_position"},
                                                {&lamp_color, "lamp_color"},
                                                {&lamp_specular, "lamp_specular"},
                                                {&lamp_reach, "lamp_reach"},
                                                {&spot_axis, "spot_axis"},
                                                {&spot_cone, "spot_cone"},
                                                {&shadow_map, "shadow_map"},
                                                {&shadow_matrix, "shadow_matrix"},
                                                {&shadow_lift, "shadow_lift"},
                                                {&shadow_texel, "shadow_texel"},
                                                {&albedo_map, "albedo_map"},
                                                {&bump_map, "bump_map"},
                                                {&glow_map, "glow_map"}};
  for (const auto& [place, name] : all) *place = program.uniform(name);
}

const GpuMesh& GpuStore::mesh(const std::shared_ptr<const Mesh>& mesh) {
  GpuMesh& gpu = made(mesh);
  if (actors_.empty() || gpu.picture == picture_) return gpu;
  gpu.picture = picture_;
  if (const auto actor = actors_.find(mesh.get()); actor != actors_.end()) bend(gpu, *actor->second);
  return gpu;
}

void GpuStore::bend(GpuMesh& mesh, const SceneActor& actor) {
  const Eigen::Isometry3d to_actor = poses_[actor.link].inverse();
  std::vector<Eigen::Isometry3d> bones;
  for (std::size_t i = 0; i < actor.skin->skin.bones.size(); ++i) bones.push_back(to_actor * poses_[actor.link + 1 + i]);
  const auto is_same = [](const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) { return a.matrix() == b.matrix(); };
  if (std::equal(bones.begin(), bones.end(), mesh.bones.begin(), mesh.bones.end(), is_same)) return;
  sim::bend(actor.skin->skin, bones, bent_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, mesh.vertices.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bent_.size() * sizeof(Vertex)), bent_.data(), GL_STREAM_DRAW);
  mesh.bones = std::move(bones);
}

GpuMesh& GpuStore::made(const std::shared_ptr<const Mesh>& mesh) {
  const auto found = meshes_.find(mesh);
  if (found != meshes_.end()) return found->second;
  GpuMesh made{
      {gl_.GenVertexArrays, gl_.DeleteVertexArrays}, {gl_.GenBuffers, gl_.DeleteBuffers}, {gl_.GenBuffers, gl_.DeleteBuffers}, {}, 0};
  gl_.BindVertexArray(made.vertex_array.name());
  gl_.BindBuffer(GL_ARRAY_BUFFER, made.vertices.name());
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh->vertices.size() * sizeof(Vertex)), mesh->vertices.data(), GL_STATIC_DRAW);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, made.indices.name());
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh->indices.size() * sizeof(std::uint32_t)), mesh->indices.data(),
                 GL_STATIC_DRAW);
  const auto attribute = [&](GLuint place, GLint size, std::size_t offset) {
    gl_.EnableVertexAttribArray(place);
    gl_.VertexAttribPointer(place, size, GL_FLOAT, GL_FALSE, sizeof(Vertex), reinterpret_cast<const void*>(offset));
  };
  attribute(0, 3, offsetof(Vertex, position));
  attribute(1, 3, offsetof(Vertex, normal));
  attribute(2, 2, offsetof(Vertex, uv));
  return meshes_.emplace(mesh, std::move(made)).first->second;
}

GLuint GpuStore::texture(const std::shared_ptr<const Texture>& texture) {
  const auto found = textures_.find(texture);
  if (found != textures_.end()) return found->second.name();
  gl::Object made(gl_.GenTextures, gl_.DeleteTextures);
  gl_.BindTexture(GL_TEXTURE_2D, made.name());
  for (std::size_t level = 0; level < texture->levels.size(); ++level) {
    const Image& image = texture->levels[level];
    gl_.TexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                   image.rgba.data());
  }
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(texture->levels.size()) - 1);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
  return textures_.emplace(texture, std::move(made)).first->second.name();
}

base::Result<SurfaceProgram*> GpuStore::program(const Features& features) {
  auto& kept = programs_[features];
  if (kept) return kept.get();
  auto built = GpuProgram::build(gl_, surface_vertex_source(features), surface_fragment_source(features));
  if (!built) return built.error();
  kept = std::make_unique<SurfaceProgram>(std::move(*built));
  return kept.get();
}

void GpuStore::begin(std::span<const Eigen::Isometry3d> poses) {
  poses_ = poses;
  ++picture_;
}

void GpuStore::enter(const Scene& scene) {
  actors_.clear();
  for (const auto& actor : scene.actors) {
    if (actor.skin) actors_[actor.mesh.get()] = &actor;
  }
  std::set<const void*> used;
  for (const auto& drawable : scene.drawables) {
    used.insert(drawable.mesh.get());
    used.insert(drawable.material.texture.get());
    used.insert(drawable.material.normal_map.get());
    used.insert(drawable.material.emissive_map.get());
  }
  for (const auto& visual : scene.visuals) used.insert(visual.signature.get());
  std::erase_if(meshes_, [&](const auto& entry) { return !used.contains(entry.first.get()); });
  std::erase_if(textures_, [&](const auto& entry) { return !used.contains(entry.first.get()); });
}

}  // namespace sim

#include "bench/bare_gl.h"

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>
#include <GL/osmesa.h>

#include <cmath>
#include <cstddef>
#include <map>
#include <stdexcept>

namespace bench {
namespace {

constexpr const char* vertex_source = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
uniform mat4 model, clip, to_map;
uniform mat3 turn;
uniform vec2 repeat;
out vec3 n;
out vec2 t;
out vec3 s;
void main() {
  vec4 p = model * vec4(position, 1.0);
  n = turn * normal;
  t = uv * repeat;
  s = (to_map * (p + vec4(normalize(n) * 0.05, 0.0))).xyz;
  gl_Position = clip * p;
}
)";

constexpr const char* fragment_source = R"(#version 330 core
in vec3 n;
in vec2 t;
in vec3 s;
out vec4 picture;
uniform sampler2D map;
uniform sampler2DShadow shadows;
uniform vec4 albedo;
uniform vec3 ambient, sun, to_sun;
void main() {
  vec3 texel = texture(map, t).rgb;
  vec3 unit = normalize(n);
  vec3 light = ambient * (1.0 + 0.25 * unit.z) + sun * max(dot(unit, to_sun), 0.0) * texture(shadows, s);
  vec3 l = clamp(albedo.rgb * texel * texel * light, 0.0, 1.0);
  vec3 q = sqrt(l);
  vec3 curve = -0.0769017564 + 0.8337588221 * q + 0.2981013597 * sqrt(q) - 0.0553171001 * l;
  picture = vec4(mix(curve, 12.92 * l, lessThan(l, vec3(0.0031308))), 1.0);
}
)";

constexpr const char* depth_vertex_source = R"(#version 330 core
layout(location = 0) in vec3 position;
uniform mat4 model, clip;
void main() { gl_Position = clip * (model * vec4(position, 1.0)); }
)";
constexpr const char* depth_fragment_source = "#version 330 core\nvoid main() {}\n";

GLuint build(const char* vertex, const char* fragment) {
  const GLuint program = glCreateProgram();
  for (const auto& [stage, source] : {std::pair<GLenum, const char*>(GL_VERTEX_SHADER, vertex), {GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  GLint is_fine = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &is_fine);
  if (is_fine == 0) throw std::runtime_error("bare GL: a program does not link");
  return program;
}

// From the world to clip coordinates for a camera along x, rows from the top.
Eigen::Matrix4f clip_of(const sim::View& view) {
  Eigen::Matrix4d axes = Eigen::Matrix4d::Zero();
  const Eigen::Matrix4d inverse = view.pose.inverse().matrix();
  axes.row(0) = -inverse.row(1);
  axes.row(1) = -inverse.row(2);
  axes.row(2) = inverse.row(0);
  axes(3, 3) = 1;
  const double n = view.near_clip, f = view.far_clip;
  Eigen::Matrix4d project = Eigen::Matrix4d::Zero();
  project(0, 0) = 1 / view.right;
  project(1, 1) = 1 / view.top;
  project(2, 2) = (f + n) / (f - n);
  project(2, 3) = -2 * f * n / (f - n);
  project(3, 2) = 1;
  return (project * axes).cast<float>();
}

}  // namespace

struct BareGl::Impl {
  struct Piece {
    GLuint array, texture;
    GLsizei count;
    std::size_t first;
    Eigen::Matrix4f model;
    Eigen::Matrix3f turn;
    Eigen::Vector4f albedo;
    Eigen::Vector2f repeat;
    bool casts_shadow;
  };

  Impl(const sim::Scene& scene, const std::vector<Eigen::Isometry3d>& poses, int shadow_size);
  ~Impl() { OSMesaDestroyContext(context); }
  GLuint upload(const sim::Mesh& mesh) const;
  GLuint upload(const sim::Texture& texture) const;
  void make_shadows(const sim::Scene& scene, const std::vector<Eigen::Isometry3d>& poses, int size);
  void resize(int w, int h);
  GLint place(const char* name) const { return glGetUniformLocation(program, name); }

  OSMesaContext context = nullptr;
  unsigned char surface[4 * 4 * 4] = {};
  GLuint program = 0, framebuffer = 0, color = 0, depth = 0, shadows = 0;
  int width = 0, height = 0;
  GLint model = 0, turn = 0, albedo = 0, repeat = 0, clip = 0;
  Eigen::Vector3f to_sun{0, 0, 1};
  Eigen::Matrix4f to_map = Eigen::Matrix4f::Identity();
  std::vector<Piece> pieces;
  sim::Color background;
};

GLuint BareGl::Impl::upload(const sim::Mesh& mesh) const {
  GLuint array = 0, buffers[2] = {};
  glGenVertexArrays(1, &array);
  glGenBuffers(2, buffers);
  glBindVertexArray(array);
  glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(sim::Vertex)), mesh.vertices.data(), GL_STATIC_DRAW);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.indices.size() * 4), mesh.indices.data(), GL_STATIC_DRAW);
  const std::size_t offsets[3] = {offsetof(sim::Vertex, position), offsetof(sim::Vertex, normal), offsetof(sim::Vertex, uv)};
  for (GLuint i = 0; i < 3; ++i) {
    glEnableVertexAttribArray(i);
    glVertexAttribPointer(i, i < 2 ? 3 : 2, GL_FLOAT, GL_FALSE, sizeof(sim::Vertex), reinterpret_cast<const void*>(offsets[i]));
  }
  return array;
}

GLuint BareGl::Impl::upload(const sim::Texture& texture) const {
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  for (std::size_t level = 0; level < texture.levels.size(); ++level) {
    const sim::Image& image = texture.levels[level];
    glTexImage2D(GL_TEXTURE_2D, static_cast<GLint>(level), GL_RGBA8, image.width, image.height, 0, GL_RGBA, GL_UNSIGNED_BYTE,
                 image.rgba.data());
  }
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, static_cast<GLint>(texture.levels.size()) - 1);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  return name;
}

void BareGl::Impl::make_shadows(const sim::Scene& scene, const std::vector<Eigen::Isometry3d>& poses, int size) {
  const Eigen::AlignedBox3d box = scene.bounds(poses);
  const double radius = 0.5 * box.diagonal().norm();
  Eigen::Matrix4d look = Eigen::Matrix4d::Identity();
  const Eigen::Vector3d z = to_sun.cast<double>();
  const Eigen::Vector3d x = Eigen::Vector3d(0, 1, 0).cross(z).normalized();
  look.block<1, 3>(0, 0) = x.transpose() / radius;
  look.block<1, 3>(1, 0) = z.cross(x).transpose() / radius;
  look.block<1, 3>(2, 0) = -z.transpose() / radius;
  look.topRightCorner<3, 1>() = -look.topLeftCorner<3, 3>() * box.center();
  Eigen::Matrix4d half = 0.5 * Eigen::Matrix4d::Identity();
  half.col(3) = Eigen::Vector4d(0.5, 0.5, 0.5, 1);
  to_map = (half * look).cast<float>();
  glGenTextures(1, &shadows);
  glBindTexture(GL_TEXTURE_2D, shadows);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, size, size, 0, GL_DEPTH_COMPONENT, GL_FLOAT, nullptr);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
  for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  GLuint target = 0;
  glGenFramebuffers(1, &target);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, shadows, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  glViewport(0, 0, size, size);
  glClear(GL_DEPTH_BUFFER_BIT);
  glEnable(GL_DEPTH_TEST);
  const GLuint depth_program = build(depth_vertex_source, depth_fragment_source);
  glUseProgram(depth_program);
  const Eigen::Matrix4f to_clip = look.cast<float>();
  glUniformMatrix4fv(glGetUniformLocation(depth_program, "clip"), 1, GL_FALSE, to_clip.data());
  for (const auto& piece : pieces) {
    if (!piece.casts_shadow) continue;
    glUniformMatrix4fv(glGetUniformLocation(depth_program, "model"), 1, GL_FALSE, piece.model.data());
    glBindVertexArray(piece.array);
    glDrawElements(GL_TRIANGLES, piece.count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(piece.first));
  }
}

BareGl::Impl::Impl(const sim::Scene& scene, const std::vector<Eigen::Isometry3d>& poses, int shadow_size) {
  ::setenv("LP_NUM_THREADS", "0", 1);
  static constexpr int attributes[] = {
      OSMESA_FORMAT, OSMESA_RGBA, OSMESA_PROFILE, OSMESA_CORE_PROFILE, OSMESA_CONTEXT_MAJOR_VERSION, 3, OSMESA_CONTEXT_MINOR_VERSION, 3, 0};
  context = OSMesaCreateContextAttribs(attributes, nullptr);
  if (context == nullptr || OSMesaMakeCurrent(context, surface, GL_UNSIGNED_BYTE, 4, 4) == 0)
    throw std::runtime_error("bare GL: no context");
  std::map<const void*, GLuint> arrays, textures;
  const sim::Texture white{{sim::Image{1, 1, {255, 255, 255, 255}}}, false};
  for (const auto& drawable : scene.drawables) {
    auto [array, is_new_array] = arrays.try_emplace(drawable.mesh.get(), 0);
    if (is_new_array) array->second = upload(*drawable.mesh);
    auto [texture, is_new_texture] = textures.try_emplace(drawable.material.texture.get(), 0);
    if (is_new_texture) texture->second = upload(drawable.material.texture ? *drawable.material.texture : white);
    const sim::MeshPart& part = drawable.mesh->parts[drawable.part];
    const Eigen::Matrix4d m = (poses[drawable.link] * drawable.in_link).matrix();
    pieces.push_back({array->second, texture->second, static_cast<GLsizei>(part.index_count), std::size_t{part.first_index} * 4,
                      m.cast<float>(), m.topLeftCorner<3, 3>().inverse().transpose().cast<float>(), drawable.material.albedo,
                      drawable.material.repeat, drawable.casts_shadow && !drawable.is_ground});
  }
  const auto& sun = scene.lights.front().light;
  to_sun = -(sun.pose.linear() * sun.direction).cast<float>();
  make_shadows(scene, poses, shadow_size);
  program = build(vertex_source, fragment_source);
  glUseProgram(program);
  glUniform1i(place("map"), 0);
  glUniform1i(place("shadows"), 1);
  const sim::Color a = scene.look.ambient;
  glUniform3f(place("ambient"), sim::to_linear(a.r), sim::to_linear(a.g), sim::to_linear(a.b));
  const auto power = static_cast<float>(sun.intensity);
  glUniform3f(place("sun"), sun.diffuse.r * power, sun.diffuse.g * power, sun.diffuse.b * power);
  glUniform3fv(place("to_sun"), 1, to_sun.data());
  glUniformMatrix4fv(place("to_map"), 1, GL_FALSE, to_map.data());
  model = place("model"), turn = place("turn"), albedo = place("albedo"), repeat = place("repeat"), clip = place("clip");
  background = scene.look.background;
}

void BareGl::Impl::resize(int w, int h) {
  if (w == width && h == height) return;
  width = w, height = h;
  glGenFramebuffers(1, &framebuffer);
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glGenRenderbuffers(1, &color);
  glBindRenderbuffer(GL_RENDERBUFFER, color);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, w, h);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
  glGenRenderbuffers(1, &depth);
  glBindRenderbuffer(GL_RENDERBUFFER, depth);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, w, h);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
  glViewport(0, 0, w, h);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);
  glActiveTexture(GL_TEXTURE1);
  glBindTexture(GL_TEXTURE_2D, shadows);
  glActiveTexture(GL_TEXTURE0);
}

BareGl::BareGl(const sim::Scene& scene, std::vector<Eigen::Isometry3d> poses, int shadow_size)
    : impl_(std::make_unique<Impl>(scene, poses, shadow_size)) {}
BareGl::~BareGl() = default;

void BareGl::draw(const sim::View& view, std::vector<std::uint8_t>& rgba) {
  Impl& i = *impl_;
  if (OSMesaGetCurrentContext() != i.context) OSMesaMakeCurrent(i.context, i.surface, GL_UNSIGNED_BYTE, 4, 4);
  i.resize(view.width, view.height);
  glClearColor(i.background.r, i.background.g, i.background.b, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const Eigen::Matrix4f clip = clip_of(view);
  glUniformMatrix4fv(i.clip, 1, GL_FALSE, clip.data());
  for (const auto& piece : i.pieces) {
    glUniformMatrix4fv(i.model, 1, GL_FALSE, piece.model.data());
    glUniformMatrix3fv(i.turn, 1, GL_FALSE, piece.turn.data());
    glUniform4fv(i.albedo, 1, piece.albedo.data());
    glUniform2fv(i.repeat, 1, piece.repeat.data());
    glBindTexture(GL_TEXTURE_2D, piece.texture);
    glBindVertexArray(piece.array);
    glDrawElements(GL_TRIANGLES, piece.count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(piece.first));
  }
  rgba.resize(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height) * 4);
  glReadPixels(0, 0, view.width, view.height, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data());
}

}  // namespace bench

#include "render/shaders.h"

namespace sim {
namespace {

std::string define(const char* name, int value) { return "#define " + std::string(name) + " " + std::to_string(value) + "\n"; }

std::string header(const Features& f) {
  std::string out = "#version 330 core\n";
  out += define("DEPTH_ONLY", f.depth_only) + define("TEXTURE", f.texture) + define("HOLES", f.holes) + define("NORMAL_MAP", f.normal_map);
  out += define("MARKS", f.marks) + define("SIGNATURE", f.signature);
  out += define("EMISSIVE_MAP", f.emissive_map);
  out += define("LIT", f.lit) + define("SPECULAR", f.specular) + define("DOUBLE_SIDED", f.double_sided) + define("GRID", f.grid);
  out += define("FOG", static_cast<int>(f.fog)) + define("SHADOW_TAPS", f.shadow_taps);
  out += define("DIRECTIONAL", f.directional) + define("POINTS", f.points) + define("SPOTS", f.spots);
  out += define("FACETED", f.faceted) + define("SHINE", f.shine);
  out += define("ROUND", f.round != RoundKind::none) + define("CYLINDER", f.round == RoundKind::cylinder);
  // Where the shadow map is looked at is linear over a triangle, but for surfaces with a back whose normal turns round.
  out += define("SHADOW_AT_VERTEX", f.shadow_taps > 0 && !f.double_sided);
  out += define("POSITION", !f.depth_only && (f.specular || f.points + f.spots > 0 || f.fog != FogKind::none || f.normal_map || f.grid ||
                                              (f.shadow_taps > 0 && f.double_sided)));
  return out;
}

// x^(SHINE / 2): a few multiplications for whole exponents, which nearly all are.
std::string power_source(int shine) {
  if (shine == 0) return "float power(float x) { return pow(x, 0.5 * shine.w); }\n";
  std::string out = "float power(float x) {\n  float p = " + std::string((shine & 1) != 0 ? "sqrt(x)" : "1.0") + ";\n";
  for (int rest = shine / 2; rest > 0; rest /= 2) {
    if ((rest & 1) != 0) out += "  p *= x;\n";
    if (rest > 1) out += "  x *= x;\n";
  }
  return out + "  return p;\n}\n";
}

// sRGB of linear light: two square roots, within 0.1/255 of the exact curve and much cheaper than a power.
constexpr const char* encode_source = R"(
vec3 encode(vec3 l) {
  l = clamp(l, 0.0, 1.0);
  vec3 s = sqrt(l);
  vec3 q = sqrt(s);
  return mix(-0.0769017564 + 0.8337588221 * s + 0.2981013597 * q - 0.0553171001 * l, 12.92 * l, lessThan(l, vec3(0.0031308)));
}
)";

constexpr const char* surface_vertex = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
uniform mat4 model;          // to camera-relative world axes
uniform mat3 normal_matrix;
uniform mat4 view_projection;
uniform vec2 repeat;
#if POSITION
out vec3 v_position;
#endif
#if LIT && !DEPTH_ONLY
#if FACETED
flat
#endif
out vec3 v_normal;
#endif
#if SHADOW_AT_VERTEX
uniform mat4 shadow_matrix;  // camera-relative to the map's [0, 1]
uniform float shadow_lift;   // along the normal [m]
out vec3 v_shadow;
#endif
#if TEXTURE
out vec2 v_uv;
#endif
#if ROUND
uniform vec2 round_size;  // radius, half the length
out vec3 v_hull;          // in the mesh
#endif
void main() {
#if ROUND
  // The triangles lie inside; these lie outside everywhere, by less than a hundredth.
  vec3 axis = vec3(0.0, 0.0, CYLINDER == 1 ? position.z : clamp(position.z, -round_size.y, round_size.y));
  v_hull = axis + (position - axis) * 1.01;
  vec4 p = model * vec4(v_hull, 1.0);
#else
  vec4 p = model * vec4(position, 1.0);
#endif
#if POSITION
  v_position = p.xyz;
#endif
#if LIT && !DEPTH_ONLY
  v_normal = normalize(normal_matrix * normal);
#endif
#if SHADOW_AT_VERTEX
  v_shadow = (shadow_matrix * vec4(p.xyz + v_normal * shadow_lift, 1.0)).xyz;
#endif
#if TEXTURE
  v_uv = uv * repeat;
#endif
  gl_Position = view_projection * p;
}
)";

// The depth of the pixel's ray where it enters a capsule (a sphere is one without length) or a cylinder, met from the triangle nearby so
// that floats are enough; pixels whose ray does not are left out.
constexpr const char* round_fragment = R"(
#if ROUND
in vec3 v_hull;
uniform vec2 round_size;
uniform vec3 round_eye;  // in the mesh
uniform mat4 model;
uniform mat4 view_projection;
// The way from p along d to a ball about the z axis; along d.xy alone: to the endless cylinder.
float entry(float a, float b, float c) {
  float root = b * b - a * c;
  if (root < 0.0) discard;
  return (-b - sqrt(root)) / a;
}
void meet_round() {
  vec3 p = v_hull, d = normalize(v_hull - round_eye);
  float square = round_size.x * round_size.x;
  float t = entry(max(dot(d.xy, d.xy), 1e-12), dot(p.xy, d.xy), dot(p.xy, p.xy) - square);
#if CYLINDER
  float turn = d.z < 0.0 ? -1.0 : 1.0, slope = max(abs(d.z), 1e-12), z = p.z * turn;
  float over = (-round_size.y - z) / slope, under = (round_size.y - z) / slope;
  float a = max(dot(d.xy, d.xy), 1e-12), b = dot(p.xy, d.xy);
  float leave = min(-2.0 * b / a - t, under);
  t = max(t, over);
  if (t > leave) discard;
#else
  float z = p.z + t * d.z;
  if (abs(z) > round_size.y) {
    p.z -= clamp(z, -round_size.y, round_size.y);
    t = entry(1.0, dot(p, d), dot(p, p) - square);
  }
#endif
  vec4 clip = view_projection * (model * vec4(v_hull + t * d, 1.0));
  float depth = 0.5 * clip.z / clip.w + 0.5;
  if (depth < 0.0 || depth > 1.0) discard;
  gl_FragDepth = depth;
}
#endif
)";

constexpr const char* surface_fragment = R"(
#if TEXTURE
in vec2 v_uv;
uniform sampler2D albedo_map;
#endif
#if DEPTH_ONLY
void main() {
#if ROUND
  meet_round();
#endif
#if HOLES
  if (texture(albedo_map, v_uv).a < 0.5) discard;
#endif
}
#elif MARKS
out vec4 picture;
uniform vec4 albedo;
void main() {
#if ROUND
  meet_round();
#endif
#if HOLES
  if (texture(albedo_map, v_uv).a < 0.5) discard;
#endif
  picture = albedo;
#if SIGNATURE
  // Textures hold square roots of linear light; signatures count in what their file has.
  picture.a = pow(dot(texture(albedo_map, v_uv).rgb, vec3(0.299, 0.587, 0.114)), 2.0 / 2.2);
#endif
}
#else
#if POSITION
in vec3 v_position;
#endif
#if LIT
#if FACETED
flat
#endif
in vec3 v_normal;
#endif
out vec4 picture;
uniform vec4 albedo;
uniform vec3 emissive;
uniform vec4 shine;  // colour, exponent
uniform vec3 ambient;
uniform vec4 fog_color;  // colour, density
uniform vec2 fog_range;  // start, 1 / (end - start)
uniform vec3 eye;  // in the world, for the grid
#if DIRECTIONAL
uniform vec3 sun_direction[DIRECTIONAL];  // to the light
uniform vec3 sun_color[DIRECTIONAL];
uniform vec3 sun_specular[DIRECTIONAL];
#endif
#if POINTS + SPOTS
uniform vec3 lamp_position[POINTS + SPOTS];  // points first; camera-relative
uniform vec3 lamp_color[POINTS + SPOTS];
uniform vec3 lamp_specular[POINTS + SPOTS];
uniform vec4 lamp_reach[POINTS + SPOTS];  // constant, linear, quadratic, range
#endif
#if SPOTS
uniform vec3 spot_axis[SPOTS];
uniform vec3 spot_cone[SPOTS];  // cos(outer / 2), 1 / (cos(inner / 2) - cos(outer / 2)), falloff
#endif
#if SHADOW_TAPS
uniform sampler2DShadow shadow_map;
#if SHADOW_AT_VERTEX
in vec3 v_shadow;
#else
uniform mat4 shadow_matrix;
uniform float shadow_lift;
#endif
uniform float shadow_texel;  // size of one in the map's [0, 1]
#endif
#if NORMAL_MAP
uniform sampler2D bump_map;
#endif
#if EMISSIVE_MAP
uniform sampler2D glow_map;
#endif
)";

constexpr const char* surface_functions = R"(
#if SPECULAR
// max(0, n.h)^shininess, from its square: h need not be made a unit vector.
float lobe(vec3 n, vec3 l, float distance) {
  vec3 h = l * distance - v_position;
  float c = max(dot(n, h), 0.0);
  return power(c * c / max(dot(h, h), 1e-12));
}
#endif
#if SHADOW_TAPS
float shade(vec3 n) {
#if SHADOW_AT_VERTEX
  vec3 s = v_shadow;
#else
  vec3 s = (shadow_matrix * vec4(v_position + n * shadow_lift, 1.0)).xyz;
#endif
  s.z = min(s.z, 1.0);
#if SHADOW_TAPS == 1
  return texture(shadow_map, s);
#else
  float sum = 0.0;
  for (int i = 0; i < SHADOW_TAPS; ++i)
    for (int k = 0; k < SHADOW_TAPS; ++k)
      sum += texture(shadow_map, s + vec3(vec2(i, k) - 0.5 * float(SHADOW_TAPS - 1), 0.0) * vec3(shadow_texel, shadow_texel, 0.0));
  return sum / float(SHADOW_TAPS * SHADOW_TAPS);
#endif
}
#endif
#if NORMAL_MAP
vec3 bumped(vec3 n) {
  vec3 dx = dFdx(v_position), dy = dFdy(v_position);
  vec2 tx = dFdx(v_uv), ty = dFdy(v_uv);
  vec3 t = dx * ty.y - dy * tx.y;
  float size = dot(t, t);
  if (size <= 0.0) return n;
  t = normalize(t * sign(tx.x * ty.y - ty.x * tx.y) - n * dot(n, t));
  vec3 bump = texture(bump_map, v_uv).xyz * 2.0 - 1.0;
  return normalize(t * bump.x + cross(n, t) * bump.y + n * bump.z);
}
#endif
#if GRID
// Share of the pixel that lines cover which are drawn every `step` metres.
float lines(vec2 p, vec2 pixel, float step, float width) {
  vec2 d = abs(fract(p / step + 0.5) - 0.5) * step;
  vec2 cover = clamp((width + 0.5 * pixel - d) / pixel, 0.0, 1.0) * clamp(2.0 * width / pixel, 0.0, 1.0);
  return max(cover.x, cover.y);
}
#endif
void main() {
#if ROUND
  meet_round();
#endif
  vec4 base = albedo;
  vec3 glow = emissive;
#if EMISSIVE_MAP
  vec3 glow_texel = texture(glow_map, v_uv).rgb;
  glow *= glow_texel * glow_texel;
#endif
#if TEXTURE
  vec4 texel = texture(albedo_map, v_uv);
#if HOLES
  if (texel.a < 0.5) discard;
#else
  base.a *= texel.a;
#endif
  vec3 image = texel.rgb * texel.rgb;
#endif
#if GRID
  vec2 ground = v_position.xy + eye.xy;
  vec2 pixel = max(abs(dFdx(ground)) + abs(dFdy(ground)), vec2(1e-4));
  float near = clamp(1.0 - length(v_position) / 60.0, 0.0, 1.0);
  base.rgb *= 1.0 - near * (0.22 * lines(ground, pixel, 1.0, 0.006) + 0.2 * lines(ground, pixel, 5.0, 0.012));
#endif
#if LIT
#if FACETED
  vec3 n = v_normal;
#else
  vec3 n = normalize(v_normal);
#endif
#if DOUBLE_SIDED
  if (!gl_FrontFacing) n = -n;
#endif
#if NORMAL_MAP && TEXTURE
  n = bumped(n);
#endif
  vec3 diffuse = ambient * (1.0 + 0.25 * n.z);
  vec3 specular = vec3(0.0);
#if SPECULAR
  float reach_v = length(v_position);
#endif
#if DIRECTIONAL
  for (int i = 0; i < DIRECTIONAL; ++i) {
    float d = max(dot(n, sun_direction[i]), 0.0);
    float open = 1.0;
#if SHADOW_TAPS
    if (i == 0) open = shade(n);
#endif
    diffuse += d * open * sun_color[i];
#if SPECULAR
    specular += (d > 0.0 ? lobe(n, sun_direction[i], reach_v) * open : 0.0) * sun_specular[i];
#endif
  }
#endif
#if POINTS + SPOTS
  for (int i = 0; i < POINTS + SPOTS; ++i) {
    vec3 l = lamp_position[i] - v_position;
    float r = length(l);
    l /= max(r, 1e-6);
    vec4 reach = lamp_reach[i];
    float strength = r < reach.w ? 1.0 / max(reach.x + r * (reach.y + r * reach.z), 1e-3) : 0.0;
#if SPOTS
    if (i >= POINTS) {
      vec3 cone = spot_cone[max(i - POINTS, 0)];
      float inside = clamp((dot(-l, spot_axis[max(i - POINTS, 0)]) - cone.x) * cone.y, 0.0, 1.0);
      strength *= inside > 0.0 ? pow(inside, cone.z) : 0.0;
    }
#endif
    float d = max(dot(n, l), 0.0) * strength;
    diffuse += d * lamp_color[i];
#if SPECULAR
    specular += (d > 0.0 ? lobe(n, l, reach_v) * strength : 0.0) * lamp_specular[i];
#endif
  }
#endif
#if TEXTURE
  vec3 light = base.rgb * diffuse;
#else
  vec3 light = base.rgb * min(diffuse, 1.2 - 0.2 / max(diffuse, vec3(1.0)));
#endif
#else
  vec3 light = base.rgb;
#endif
#if TEXTURE
#if EMISSIVE_MAP
  light = glow + min(light, 1.0) * image;
#else
  light = min(glow + light, 1.0) * image;
#endif
#else
  light += glow;
#endif
#if LIT && SPECULAR
  light += specular * shine.rgb;
#endif
#if FOG
  float distance = length(v_position);
#if FOG == 1
  float f = clamp((distance - fog_range.x) * fog_range.y, 0.0, 1.0);
#elif FOG == 2
  float f = 1.0 - exp(-fog_color.w * distance);
#else
  float f = 1.0 - exp(-fog_color.w * fog_color.w * distance * distance);
#endif
  light = mix(light, fog_color.rgb, f);
#endif
  picture = vec4(encode(light), base.a);
}
#endif
)";

}  // namespace

std::string surface_vertex_source(const Features& features) { return header(features) + surface_vertex; }
std::string surface_fragment_source(const Features& features) {
  // The functions close the conditional that the declarations open: without colour there is nothing else.
  const std::string power = features.specular ? power_source(features.shine) : std::string();
  return header(features) + round_fragment + surface_fragment + power + encode_source + surface_functions;
}

std::string sky_vertex_source() {
  return R"(#version 330 core
layout(location = 0) in vec3 position;
uniform vec3 forward, right, up;  // world directions of the picture's middle, and to its right and upper edge
uniform vec2 middle;              // of the frustum, in its half widths
out vec3 v_direction;
void main() {
  v_direction = forward + (position.x + middle.x) * right + (middle.y - position.y) * up;
  gl_Position = vec4(position.xy, 1.0, 1.0);
}
)";
}

std::string sky_fragment_source() {
  return std::string(R"(#version 330 core
in vec3 v_direction;
out vec4 picture;
uniform vec3 zenith, horizon, ground;  // linear
uniform vec3 sun_direction;
uniform vec3 sun_glow;  // linear
)") + encode_source +
         R"(
void main() {
  vec3 d = normalize(v_direction);
  float h = max(d.z, 0.0);
  float s = sqrt(sqrt(h));
  vec3 sky = mix(horizon, zenith, clamp(s * 1.25 - 0.25 + 0.1 * h, 0.0, 1.0));
  float toward = max(dot(d, sun_direction), 0.0);
  float t2 = toward * toward, t4 = t2 * t2, t8 = t4 * t4;
  float t64 = t8 * t8 * t8 * t8 * t8 * t8 * t8 * t8;
  sky += sun_glow * (0.12 * t8 + 0.25 * t64 + smoothstep(0.9994, 0.9998, toward));
  sky = mix(sky, ground, smoothstep(0.0, 0.02, -d.z));
  picture = vec4(encode(sky), 1.0);
}
)";
}

std::string overlay_vertex_source() {
  return R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 color;
uniform mat4 view_projection;
out vec4 v_color;
void main() {
  v_color = color;
  gl_Position = view_projection * vec4(position, 1.0);
}
)";
}

std::string overlay_fragment_source() {
  return R"(#version 330 core
in vec4 v_color;
out vec4 picture;
void main() { picture = v_color; }
)";
}

}  // namespace sim

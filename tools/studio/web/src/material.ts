// Surfaces drawn by the same formula as the simulator's pictures (sim-server/render/shaders.h), so that both look alike.
import { Color, DoubleSide, FrontSide, Matrix4, Object3D, ShaderMaterial, Texture, UniformsLib, UniformsUtils, Vector3, Vector4 } from 'three';

export interface Look {
  ambient: number[]; background: number[]; shadows: boolean; grid: boolean;
  sky?: { time: number; sunrise: number; sunset: number };
  fog?: { type: string; color: number[]; start: number; end: number; density: number };
  camera?: { position: number[]; rotation: number[] };
}
export interface SceneLight {
  name: string; type: 'directional' | 'point' | 'spot'; range?: number; spot?: { innerConeAngle: number; outerConeAngle: number };
  extras: { diffuse: number[]; specular: number[]; intensity: number; attenuation: number[]; falloff: number; casts_shadow: boolean };
  node: Object3D;
}
export type Surface = ShaderMaterial;

export const linear = (srgb: number[]): Color => new Color().setRGB(srgb[0], srgb[1], srgb[2], 'srgb');

// What all surfaces share; changed in place when lights move.
export interface SharedLights { [name: string]: { value: any } }

const max_lamps = 8;

export const suns_of = (lights: SceneLight[]): SceneLight[] => lights.filter((l) => l.type === 'directional')
  .sort((a, b) => Number(b.extras.casts_shadow) - Number(a.extras.casts_shadow));
export const lamps_of = (lights: SceneLight[]): SceneLight[] => lights.filter((l) => l.type !== 'directional').slice(0, max_lamps);

const shared = new WeakMap<Look, SharedLights>();

export function shared_lights(look: Look, lights: SceneLight[]): SharedLights {
  let kept = shared.get(look);
  if (kept) return kept;
  const suns = suns_of(lights).length, lamps = lamps_of(lights).length;
  const vectors = (n: number) => Array.from({ length: Math.max(1, n) }, () => new Vector3());
  kept = {
    sun_direction: { value: vectors(suns) }, sun_color: { value: vectors(suns) }, sun_specular: { value: vectors(suns) },
    lamp_position: { value: vectors(lamps) }, lamp_color: { value: vectors(lamps) }, lamp_specular: { value: vectors(lamps) },
    lamp_reach: { value: Array.from({ length: Math.max(1, lamps) }, () => new Vector4()) }, lamp_axis: { value: vectors(lamps) }, lamp_cone: { value: vectors(lamps) },
    ambient_light: { value: linear(look.ambient) },
    fog_tint: { value: look.fog ? linear(look.fog.color) : new Color() },
    fog_reach: { value: look.fog ? new Vector3(look.fog.start, 1 / Math.max(1e-6, look.fog.end - look.fog.start), look.fog.density) : new Vector3() },
  };
  shared.set(look, kept);
  return kept;
}

// Where the lights are now.
export function place_lights(look: Look, lights: SceneLight[]): void {
  const values = shared_lights(look, lights);
  const direction = new Vector3(), matrix = new Matrix4();
  const along = (light: SceneLight) => {
    light.node.updateWorldMatrix(true, false);
    return direction.set(0, 0, -1).transformDirection(matrix.copy(light.node.matrixWorld));
  };
  suns_of(lights).forEach((light, i) => {
    values.sun_direction.value[i].copy(along(light)).negate();
    values.sun_color.value[i].fromArray(light.extras.diffuse).multiplyScalar(light.extras.intensity);
    values.sun_specular.value[i].fromArray(light.extras.specular).multiplyScalar(light.extras.intensity);
  });
  lamps_of(lights).forEach((light, i) => {
    values.lamp_axis.value[i].copy(along(light));
    values.lamp_position.value[i].setFromMatrixPosition(light.node.matrixWorld);
    values.lamp_color.value[i].fromArray(light.extras.diffuse).multiplyScalar(light.extras.intensity);
    values.lamp_specular.value[i].fromArray(light.extras.specular).multiplyScalar(light.extras.intensity);
    const [constant, slope, square] = light.extras.attenuation;
    values.lamp_reach.value[i].set(constant, slope, square, light.range ?? 1e9);
    const outer = Math.cos(light.spot?.outerConeAngle ?? 0), inner = Math.cos(light.spot?.innerConeAngle ?? 0);
    values.lamp_cone.value[i].set(light.spot ? outer : -2, 1 / Math.max(1e-4, inner - outer), light.spot ? light.extras.falloff : 0);
  });
}

const vertex = `
#include <common>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
varying vec3 v_normal;
varying vec3 v_place;
varying vec2 v_uv;
uniform vec2 repeat;
void main() {
  v_uv = uv * repeat;
  #include <beginnormal_vertex>
  #include <skinbase_vertex>
  #include <skinnormal_vertex>
  #include <defaultnormal_vertex>
  #include <begin_vertex>
  #include <skinning_vertex>
  #include <project_vertex>
  vec4 worldPosition = modelMatrix * vec4(transformed, 1.0);
  #include <shadowmap_vertex>
  v_normal = inverseTransformDirection(transformedNormal, viewMatrix);
  v_place = worldPosition.xyz;
}`;

const fragment = `
#include <common>
#include <packing>
#include <lights_pars_begin>
#include <shadowmap_pars_fragment>
varying vec3 v_normal;
varying vec3 v_place;
varying vec2 v_uv;
uniform vec4 albedo;
uniform vec3 emissive;
uniform vec4 shine;
uniform vec3 ambient_light;
uniform vec3 fog_tint;
uniform vec3 fog_reach;
uniform sampler2D color_map, bump_map, glow_map;
#if SUNS
uniform vec3 sun_direction[SUNS], sun_color[SUNS], sun_specular[SUNS];
#endif
#if LAMPS
uniform vec3 lamp_position[LAMPS], lamp_color[LAMPS], lamp_specular[LAMPS], lamp_axis[LAMPS], lamp_cone[LAMPS];
uniform vec4 lamp_reach[LAMPS];
#endif
float lobe(vec3 n, vec3 l, vec3 v) {
  return pow(max(dot(n, normalize(l + v)), 0.0), shine.w);
}
vec3 bumped(vec3 n) {
  vec3 dx = dFdx(v_place), dy = dFdy(v_place);
  vec2 tx = dFdx(v_uv), ty = dFdy(v_uv);
  vec3 t = dx * ty.y - dy * tx.y;
  if (dot(t, t) <= 0.0) return n;
  t = normalize(t * sign(tx.x * ty.y - ty.x * tx.y) - n * dot(n, t));
  vec3 bump = texture2D(bump_map, v_uv).xyz * 2.0 - 1.0;
  return normalize(t * bump.x + cross(n, t) * bump.y + n * bump.z);
}
float lines(vec2 p, vec2 pixel, float spacing, float width) {
  vec2 d = abs(fract(p / spacing + 0.5) - 0.5) * spacing;
  vec2 cover = clamp((width + 0.5 * pixel - d) / pixel, 0.0, 1.0) * clamp(2.0 * width / pixel, 0.0, 1.0);
  return max(cover.x, cover.y);
}
void main() {
  vec4 base = albedo;
  vec3 glow = emissive;
  vec3 image = vec3(1.0);
#if HAS_GLOW
  glow *= texture2D(glow_map, v_uv).rgb;
#endif
#if HAS_COLOR
  vec4 texel = texture2D(color_map, v_uv);
  #if HOLES
  if (texel.a < 0.5) discard;
  #else
  base.a *= texel.a;
  #endif
  image = texel.rgb;
#endif
  vec3 way = v_place - cameraPosition;
  float far = length(way);
#if GRID
  vec2 pixel = max(abs(dFdx(v_place.xy)) + abs(dFdy(v_place.xy)), vec2(1e-4));
  float near = isOrthographic ? 1.0 : clamp(1.0 - far / 60.0, 0.0, 1.0);
  base.rgb *= 1.0 - near * (0.22 * lines(v_place.xy, pixel, 1.0, 0.006) + 0.2 * lines(v_place.xy, pixel, 5.0, 0.012));
#endif
#if LIT
  vec3 n = normalize(v_normal);
  #if TWO_SIDED
  if (!gl_FrontFacing) n = -n;
  #endif
  #if HAS_BUMPS
  n = bumped(n);
  #endif
  vec3 v = isOrthographic ? vec3(viewMatrix[0][2], viewMatrix[1][2], viewMatrix[2][2]) : -way / max(far, 1e-6);
  vec3 diffuse = ambient_light * (1.0 + 0.25 * n.z);
  vec3 specular = vec3(0.0);
  #if SUNS
  for (int i = 0; i < SUNS; ++i) {
    float d = max(dot(n, sun_direction[i]), 0.0);
    float open = 1.0;
    #if NUM_DIR_LIGHT_SHADOWS > 0
    if (i == 0 && receiveShadow) {
      DirectionalLightShadow s = directionalLightShadows[0];
      open = getShadow(directionalShadowMap[0], s.shadowMapSize, s.shadowIntensity, s.shadowBias, s.shadowRadius, vDirectionalShadowCoord[0]);
    }
    #endif
    diffuse += d * open * sun_color[i];
    if (shine.w > 0.0 && d > 0.0) specular += lobe(n, sun_direction[i], v) * open * sun_specular[i];
  }
  #endif
  #if LAMPS
  for (int i = 0; i < LAMPS; ++i) {
    vec3 l = lamp_position[i] - v_place;
    float r = length(l);
    l /= max(r, 1e-6);
    vec4 reach = lamp_reach[i];
    float strength = r < reach.w ? 1.0 / max(reach.x + r * (reach.y + r * reach.z), 1e-3) : 0.0;
    float inside = clamp((dot(-l, lamp_axis[i]) - lamp_cone[i].x) * lamp_cone[i].y, 0.0, 1.0);
    if (lamp_cone[i].x > -1.5) strength *= inside > 0.0 ? pow(inside, lamp_cone[i].z) : 0.0;
    float d = max(dot(n, l), 0.0) * strength;
    diffuse += d * lamp_color[i];
    if (shine.w > 0.0 && d > 0.0) specular += lobe(n, l, v) * strength * lamp_specular[i];
  }
  #endif
  vec3 light = base.rgb * min(diffuse, 1.2 - 0.2 / max(diffuse, vec3(1.0))); // as the simulator: light above 1 counts little
#else
  vec3 light = base.rgb;
  vec3 specular = vec3(0.0);
#endif
#if HAS_COLOR
  #if HAS_GLOW
  light = glow + min(light, 1.0) * image;
  #else
  light = min(glow + light, 1.0) * image;
  #endif
#else
  light += glow;
#endif
  light += specular * shine.rgb;
#if FOG_KIND
  #if FOG_KIND == 1
  float f = clamp((far - fog_reach.x) * fog_reach.y, 0.0, 1.0);
  #elif FOG_KIND == 2
  float f = 1.0 - exp(-fog_reach.z * far);
  #else
  float f = 1.0 - exp(-fog_reach.z * fog_reach.z * far * far);
  #endif
  light = mix(light, fog_tint, f);
#endif
  gl_FragColor = vec4(clamp(light, 0.0, 1.0), base.a);
  #include <colorspace_fragment>
}`;

const fog_kinds: { [type: string]: number } = { linear: 1, exponential: 2, exp: 2, quadratic: 3, exp2: 3 };

export function make_material(gltf: any, has_grid: boolean, textures: (Texture | null)[], look: Look, lights: SceneLight[]): Surface {
  const pbr = gltf.pbrMetallicRoughness ?? {};
  const used = [pbr.baseColorTexture, gltf.normalTexture, gltf.emissiveTexture];
  const map = (info: any) => (info ? textures[info.index] : null);
  const scale = used.find((info) => info)?.extensions?.KHR_texture_transform?.scale ?? [1, 1];
  const fog = look.fog && look.fog.type !== 'none' ? fog_kinds[look.fog.type] ?? 0 : 0;
  const material = new ShaderMaterial({
    vertexShader: vertex,
    fragmentShader: fragment,
    lights: true,
    defines: {
      SUNS: suns_of(lights).length, LAMPS: lamps_of(lights).length, LIT: gltf.extensions?.KHR_materials_unlit ? 0 : 1, GRID: has_grid && look.grid ? 1 : 0,
      HAS_COLOR: used[0] ? 1 : 0, HAS_BUMPS: used[1] ? 1 : 0, HAS_GLOW: used[2] ? 1 : 0, HOLES: gltf.alphaMode === 'MASK' ? 1 : 0, TWO_SIDED: gltf.doubleSided ? 1 : 0,
      FOG_KIND: fog,
    },
    uniforms: {
      ...UniformsUtils.clone(UniformsLib.lights),
      albedo: { value: new Vector4().fromArray(pbr.baseColorFactor ?? [1, 1, 1, 1]) },
      emissive: { value: new Vector3().fromArray(gltf.emissiveFactor ?? [0, 0, 0]) },
      shine: { value: new Vector4(...(gltf.extras?.specular ?? [0, 0, 0]), gltf.extras?.shininess ?? 0) },
      repeat: { value: { x: scale[0], y: scale[1] } },
      color_map: { value: map(used[0]) }, bump_map: { value: map(used[1]) }, glow_map: { value: map(used[2]) },
      receiveShadow: { value: true },
    },
    side: gltf.doubleSided ? DoubleSide : FrontSide,
    shadowSide: DoubleSide,
    transparent: gltf.alphaMode === 'BLEND',
    depthWrite: gltf.alphaMode !== 'BLEND',
  });
  Object.assign(material.uniforms, shared_lights(look, lights));
  return material;
}

// The sky behind everything: a gradient by the hour.
export function sky_material(look: Look, lights: SceneLight[]): ShaderMaterial | null {
  const sky = look.sky;
  if (!sky) return null;
  const day = [[0.075, 0.22, 0.56], [0.52, 0.69, 0.87], [0.34, 0.37, 0.38], [1.0, 0.9, 0.7]];
  const dusk = [[0.06, 0.09, 0.25], [0.75, 0.36, 0.16], [0.13, 0.11, 0.11], [1.0, 0.5, 0.2]];
  const night = [[0.002, 0.004, 0.012], [0.008, 0.012, 0.03], [0.004, 0.005, 0.006], [0.05, 0.05, 0.06]];
  const edge = Math.min(Math.abs(sky.time - sky.sunrise), Math.abs(sky.time - sky.sunset));
  const full = sky.time > sky.sunrise && sky.time < sky.sunset ? day : night;
  const share = Math.min(1, Math.max(0, edge / 1.5));
  const mixed = dusk.map((color, i) => new Vector3().fromArray(color.map((c, k) => c + (full[i][k] - c) * share)));
  const values = shared_lights(look, lights);
  return new ShaderMaterial({
    depthWrite: false,
    depthTest: false,
    uniforms: {
      zenith: { value: mixed[0] }, horizon: { value: mixed[1] }, ground: { value: mixed[2] }, glow: { value: suns_of(lights).length > 0 ? mixed[3] : new Vector3() },
      sun_direction: values.sun_direction, inverse_projection: { value: new Matrix4() }, camera_world: { value: new Matrix4() },
    },
    vertexShader: `
uniform mat4 inverse_projection, camera_world;
varying vec3 v_direction;
void main() {
  vec4 p = inverse_projection * vec4(position.xy, 1.0, 1.0);
  v_direction = mat3(camera_world) * (p.xyz / p.w);
  gl_Position = vec4(position.xy, 1.0, 1.0);
}`,
    fragmentShader: `
varying vec3 v_direction;
uniform vec3 zenith, horizon, ground, glow;
uniform vec3 sun_direction[1];
void main() {
  vec3 d = normalize(v_direction);
  float h = max(d.z, 0.0);
  float s = sqrt(sqrt(h));
  vec3 sky = mix(horizon, zenith, clamp(s * 1.25 - 0.25 + 0.1 * h, 0.0, 1.0));
  float t2 = pow(max(dot(d, sun_direction[0]), 0.0), 2.0), t8 = t2 * t2 * t2 * t2;
  sky += glow * (0.12 * t8 + 0.25 * pow(t8, 8.0) + smoothstep(0.9994, 0.9998, max(dot(d, sun_direction[0]), 0.0)));
  sky = mix(sky, ground, smoothstep(0.0, 0.02, -d.z));
  gl_FragColor = vec4(clamp(sky, 0.0, 1.0), 1.0);
  #include <colorspace_fragment>
}`,
  });
}

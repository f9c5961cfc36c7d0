#include "render/lights.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sim {
namespace {

// Lights are linear already.
Eigen::Vector3f radiance(const Color& color, double intensity) {
  return Eigen::Vector3f(color.r, color.g, color.b) * static_cast<float>(intensity);
}

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

}  // namespace

Eigen::Vector3f linear(const Color& color) { return {to_linear(color.r), to_linear(color.g), to_linear(color.b)}; }

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
  if (out.lamps.size() > max_lamps) {
    out.all = out.lamps;
    out.lamps.resize(max_lamps);
  }
  std::stable_partition(out.lamps.begin(), out.lamps.end(), [](const Lamp& lamp) { return !lamp.is_spot; });
  for (const auto& lamp : out.lamps) ++(lamp.is_spot ? out.spots : out.points);
  return out;
}

std::vector<Lamp> lamps_at(const Lights& lights, const Eigen::Vector3f& centre, float radius) {
  std::vector<std::pair<float, const Lamp*>> order;
  for (const Lamp& lamp : lights.all) {
    const float d = std::max(0.0F, (lamp.position - centre).norm() - radius);
    const float reached = d < lamp.reach.w() ? 1 / std::max(lamp.reach.x() + d * (lamp.reach.y() + d * lamp.reach.z()), 1e-3F) : 0;
    order.emplace_back(lamp.color.sum() * reached, &lamp);
  }
  // Of equally strong ones those that are strongest at the camera.
  std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Lamp> out;
  for (const bool is_spot : {false, true}) {
    int left = is_spot ? lights.spots : lights.points;
    for (const auto& [strength, lamp] : order) {
      if (lamp->is_spot != is_spot || left == 0) continue;
      out.push_back(*lamp);
      --left;
    }
  }
  return out;
}

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

}  // namespace sim

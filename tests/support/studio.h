// A scene with a renderer before it, and the arithmetic that pictures are compared with: sRGB in doubles.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "support/scene_maker.h"

namespace sim::test {

inline std::unique_ptr<Renderer> open_renderer() {
  auto opened = Renderer::open();
  if (!opened) throw std::runtime_error(opened.error().message);
  return std::move(*opened);
}
// Compiling shaders takes a while; most tests can share one.
inline Renderer& shared_renderer() {
  static const std::unique_ptr<Renderer> renderer = open_renderer();
  return *renderer;
}

struct Studio {
  Assets assets;
  Renderer* renderer;
  std::shared_ptr<const Scene> scene;
  std::vector<Eigen::Isometry3d> poses;

  explicit Studio(const WorldDef& world, Renderer& with = shared_renderer(), Scene::Content content = Scene::Content::visuals)
      : renderer(&with), scene(Scene::build(world, assets, content)), poses(scene->start_poses()) {}
  Image picture(const View& view, const Overlay* overlay = nullptr) {
    const auto drawn = renderer->draw(scene, poses, view, overlay);
    if (!drawn) throw std::runtime_error(drawn.error().message);
    Image image{view.width, view.height, {}};
    image.rgba.resize(image.size_bytes());
    renderer->read_rgba(image.rgba);
    return image;
  }
  std::vector<float> depth(View view) {
    view.wants_color = false;
    const auto drawn = renderer->draw(scene, poses, view);
    if (!drawn) throw std::runtime_error(drawn.error().message);
    std::vector<float> out(static_cast<std::size_t>(view.width * view.height));
    renderer->read_depth(out);
    return out;
  }
};

inline std::array<int, 3> pixel(const Image& image, int x, int y) {
  const std::uint8_t* p = &image.rgba[static_cast<std::size_t>(y * image.width + x) * 4];
  return {p[0], p[1], p[2]};
}

inline double decode(double v) { return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4); }
inline double encode(double l) {
  l = std::clamp(l, 0.0, 1.0);
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
}
inline Eigen::Vector3d linear_of(const Color& c) { return {decode(c.r), decode(c.g), decode(c.b)}; }

// Tolerance in steps of a byte.
inline ::testing::AssertionResult is_near(const std::array<int, 3>& got, const Eigen::Vector3d& linear, double tolerance = 1) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = encode(linear[static_cast<Eigen::Index>(c)]) * 255;
    if (std::abs(got[c] - expected) > tolerance)
      return ::testing::AssertionFailure() << "colour " << got[0] << ' ' << got[1] << ' ' << got[2] << ": component " << c << " is "
                                           << got[c] << ", expected " << expected;
  }
  return ::testing::AssertionSuccess();
}
inline ::testing::AssertionResult is_bytes(const std::array<int, 3>& got, const std::array<int, 3>& expected, int tolerance = 1) {
  for (std::size_t c = 0; c < 3; ++c) {
    if (std::abs(got[c] - expected[c]) > tolerance)
      return ::testing::AssertionFailure() << "colour " << got[0] << ' ' << got[1] << ' ' << got[2] << ", expected " << expected[0] << ' '
                                           << expected[1] << ' ' << expected[2];
  }
  return ::testing::AssertionSuccess();
}

// 5 m above the ground, looking down: up in the picture is x of the world, its left is y.
inline Eigen::Isometry3d looking_down() { return at(0, 0, 5, 0, M_PI / 2); }

}  // namespace sim::test

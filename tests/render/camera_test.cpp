// Cameras: formats, noise, lenses.
#include "render/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "render/pixels.h"
#include "support/scene_maker.h"

namespace sim {
namespace {

using test::at;
using test::glowing_material;
using test::one_visual_model;

// Compiling shaders takes a while; the tests share one.
Renderer& shared_renderer() {
  static const std::unique_ptr<Renderer> renderer = Renderer::open().value();
  return *renderer;
}

struct Set {
  Assets assets;
  std::shared_ptr<const Scene> scene;
  std::vector<Eigen::Isometry3d> poses;

  explicit Set(const WorldDef& world) : scene(Scene::build(world, assets)), poses(scene->start_poses()) {}
  void take(Camera& camera, std::int64_t time = 0) {
    const auto taken = camera.take(shared_renderer(), scene, poses, Eigen::Isometry3d::Identity(), time);
    ASSERT_TRUE(taken.ok()) << taken.error().message;
  }
  std::vector<std::uint8_t> color(Camera& camera, std::int64_t time = 0) {
    take(camera, time);
    std::vector<std::uint8_t> out(camera.color_bytes());
    camera.write_color(out);
    return out;
  }
};

WorldDef grey_world() {
  WorldDef world = test::dark_world();
  world.scene.background = {0.5F, 0.5F, 0.5F, 1};
  return world;
}

WorldDef marker_world(const Eigen::Vector3d& place) {
  WorldDef world = test::dark_world();
  world.models.push_back(one_visual_model("marker", SphereShape{0.04 * place.norm() / 3}, at(place.x(), place.y(), place.z()),
                                          glowing_material({1, 1, 1, 1})));
  return world;
}

Eigen::Vector2d bright_middle(const std::vector<std::uint8_t>& rgb, int width) {
  Eigen::Vector2d sum(0, 0);
  double weight = 0;
  for (std::size_t i = 0; i < rgb.size() / 3; ++i) {
    const double w = rgb[3 * i];
    sum += w * Eigen::Vector2d(static_cast<double>(i % static_cast<std::size_t>(width)) + 0.5,
                               static_cast<double>(i / static_cast<std::size_t>(width)) + 0.5);
    weight += w;
  }
  return sum / weight;
}

TEST(Pixels, fast_conversion_drops_every_fourth_byte) {
  std::vector<std::uint8_t> rgba(4 * 1003), rgb(3 * 1003);
  std::iota(rgba.begin(), rgba.end(), std::uint8_t{0});
  rgba_to_rgb(rgba, rgb);
  for (std::size_t i = 0; i < rgb.size(); ++i) ASSERT_EQ(rgb[i], rgba[i / 3 * 4 + i % 3]) << i;
}

TEST(Pixels, mono_of_grey_is_the_same_grey) {
  for (int v = 0; v < 256; ++v) {
    const auto b = static_cast<std::uint8_t>(v);
    const std::vector<std::uint8_t> rgba{b, b, b, 255};
    std::vector<std::uint8_t> out(1);
    rgba_to_mono(rgba, out);
    EXPECT_EQ(out[0], b);
  }
}

TEST(Camera, publishes_red_green_blue_from_the_top_left_on) {
  WorldDef world = test::dark_world();
  world.models.push_back(one_visual_model("plate", BoxShape{{0.1, 4, 4}}, at(3, 2, 2), glowing_material({1, 0.5F, 0, 1})));
  Set set(world);
  CameraDef def;
  def.width = 40;
  def.height = 30;
  Camera camera(def, Camera::Output::color, 1);
  const auto rgb = set.color(camera);
  ASSERT_EQ(rgb.size(), 40U * 30U * 3U);
  EXPECT_EQ(rgb[0], 255);  // left and up is +y and +z
  EXPECT_NEAR(rgb[1], 128, 1);
  EXPECT_EQ(rgb[2], 0);
  EXPECT_EQ(rgb[rgb.size() - 3], 0);
}

TEST(Camera, mono_formats_publish_one_byte_a_pixel) {
  Set set(grey_world());
  CameraDef def;
  def.format = PixelFormat::mono8;
  Camera camera(def, Camera::Output::color, 1);
  const auto mono = set.color(camera);
  EXPECT_EQ(mono.size(), 320U * 240U);
  EXPECT_NEAR(mono[100], 128, 1);
}

TEST(Camera, noise_has_its_mean_and_deviation_and_repeats_by_seed_and_time) {
  Set set(grey_world());
  CameraDef def;
  def.noise = {NoiseDef::Kind::gaussian, 0.02, 0.05, 0, 0, 0, 0, 0};
  Camera camera(def, Camera::Output::color, 42), same(def, Camera::Output::color, 42), other(def, Camera::Output::color, 43);
  const auto rgb = set.color(camera, 1000);
  double sum = 0, squares = 0;
  for (const auto v : rgb) sum += v, squares += static_cast<double>(v) * v;
  const double mean = sum / static_cast<double>(rgb.size());
  EXPECT_NEAR(mean, 127.5 + 0.02 * 255, 0.6);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(rgb.size()) - mean * mean), 0.05 * 255, 0.2);
  EXPECT_EQ(rgb, set.color(same, 1000));
  EXPECT_NE(rgb, set.color(other, 1000));
  EXPECT_NE(rgb, set.color(same, 2000));
}

// Facets of such a ball lie centimetres beside it near its rim.
TEST(Camera, balls_are_round_for_whoever_measures_them) {
  WorldDef world = test::dark_world();
  world.models.push_back(one_visual_model("ball", SphereShape{1.5}, at(4, 0, 0), glowing_material({1, 1, 1, 1})));
  Set set(world);
  CameraDef def;
  std::vector<std::uint8_t> colors;
  for (const auto output : {Camera::Output::depth, Camera::Output::color_and_depth}) {
    Camera camera(def, output, 1);
    set.take(camera, 5);
    const double focal = camera.focal_length();
    int seen = 0;
    for (int x = 0; x < 320; ++x) {
      const Eigen::Vector3d ray(1, (159.5 - x) / focal, 0.5 / focal);
      const double a = ray.squaredNorm(), b = 4, c = 16 - 1.5 * 1.5;
      const double root = b * b - a * c;
      const float got = camera.depth()[static_cast<std::size_t>(120 * 320 + x)];
      if (std::abs(root) < 0.05) continue;  // the rim
      if (root < 0) {
        EXPECT_TRUE(std::isinf(got)) << x;
        continue;
      }
      EXPECT_NEAR(got, (b - std::sqrt(root)) / a, 0.001 + 0.001 * (b - std::sqrt(root)) / a) << x;
      ++seen;
    }
    EXPECT_GT(seen, 150);
    if (output == Camera::Output::color_and_depth) colors = set.color(camera, 5);
  }
  // The colours are the same whether somebody looks at the depth or not.
  Camera camera(def, Camera::Output::color_and_depth, 1);
  ASSERT_TRUE(camera.take(shared_renderer(), set.scene, set.poses, Eigen::Isometry3d::Identity(), 5, Camera::Output::color).ok());
  std::vector<std::uint8_t> alone(camera.color_bytes());
  camera.write_color(alone);
  EXPECT_TRUE(alone == colors);
}

TEST(Camera, depth_noise_leaves_infinity_alone) {
  WorldDef world = test::dark_world();
  world.models.push_back(one_visual_model("wall", BoxShape{{0.1, 2, 20}}, at(3.05, 0, 0), glowing_material({1, 1, 1, 1})));
  Set set(world);
  CameraDef def;
  def.noise = {NoiseDef::Kind::gaussian, 0, 0.01, 0, 0, 0, 0, 0};
  Camera camera(def, Camera::Output::depth, 1);
  set.take(camera, 5);
  EXPECT_TRUE(std::isinf(camera.depth()[0]));
  EXPECT_NEAR(camera.depth()[120 * 320 + 160], 3, 0.06);
  EXPECT_NE(camera.depth()[120 * 320 + 160], camera.depth()[120 * 320 + 161]);
  std::vector<float> points(camera.pixels() * 3);
  camera.write_points(points);
  EXPECT_TRUE(std::isnan(points[0]));
  const std::size_t p = (120 * 320 + 200) * 3;
  EXPECT_NEAR(points[p], 3, 0.06);
  EXPECT_NEAR(points[p + 1], -points[p] * 40.5 / camera.focal_length(), 1e-4);
}

TEST(Camera, distortion_moves_points_as_its_polynomial_says) {
  DistortionDef d;
  d.k1 = -0.25;
  d.k2 = 0.06;
  d.p1 = 0.003;
  d.p2 = -0.002;
  for (const auto& place : {Eigen::Vector3d(3, 0.9, 0.5), Eigen::Vector3d(3, -1.2, -0.8), Eigen::Vector3d(4, 0, 1.1)}) {
    Set set(marker_world(place));
    CameraDef def;
    def.distortion = d;
    def.width = 160;
    def.height = 120;
    Camera camera(def, Camera::Output::color, 1);
    const Eigen::Vector2d p(-place.y() / place.x(), -place.z() / place.x());
    const double r2 = p.squaredNorm(), radial = 1 + d.k1 * r2 + d.k2 * r2 * r2;
    const Eigen::Vector2d seen(p.x() * radial + 2 * d.p1 * p.x() * p.y() + d.p2 * (r2 + 2 * p.x() * p.x()),
                               p.y() * radial + d.p1 * (r2 + 2 * p.y() * p.y()) + 2 * d.p2 * p.x() * p.y());
    const Eigen::Vector2d expected = Eigen::Vector2d(80, 60) + camera.focal_length() * seen;
    EXPECT_LT((bright_middle(set.color(camera), 160) - expected).norm(), 0.5) << place.transpose();
  }
}

TEST(Camera, an_equidistant_lens_sees_half_the_world) {
  for (const double angle : {0.2, 0.7, 1.2, 1.5}) {
    Set set(marker_world(3 * Eigen::Vector3d(std::cos(angle), -std::sin(angle) * 0.8, std::sin(angle) * 0.6)));
    CameraDef def;
    def.horizontal_fov = M_PI;
    def.lens = LensDef{};
    def.lens->type = "equidistant";
    def.lens->cutoff_angle = M_PI;
    def.lens->environment_texture_size = 512;
    Camera camera(def, Camera::Output::color, 1);
    const double radius = 160 * angle / (M_PI / 2);
    const Eigen::Vector2d expected(160 + 0.8 * radius, 120 - 0.6 * radius);
    EXPECT_LT((bright_middle(set.color(camera), 320) - expected).norm(), 0.6) << angle;
  }
}

}  // namespace
}  // namespace sim

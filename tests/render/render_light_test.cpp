// The colours of surfaces against the formula of light in shaders.h, computed here in doubles.
#include <gtest/gtest.h>

#include <random>

#include "render/camera.h"
#include "support/studio.h"

namespace sim {
namespace {

using namespace test;
using Eigen::Vector3d;

Vector3d rgb(const Color& c) { return {c.r, c.g, c.b}; }
Vector3d toned(const Vector3d& received) {
  return received.unaryExpr([](double d) { return std::min(d, 1.2 - 0.2 / std::max(d, 1.0)); });
}

TEST(RenderLight, lit_flat_surfaces_have_the_colours_of_the_formula) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 25; ++i) {
    WorldDef world = test::dark_world();
    world.scene.ambient = {0.5F * unit(random), 0.5F * unit(random), 0.5F * unit(random), 1};
    const Color diffuse{unit(random), unit(random), unit(random), 1};
    const Color light{unit(random), unit(random), unit(random), 1};
    const double tilt = 0.6 * unit(random);
    const Eigen::Vector3d direction(unit(random) - 0.5, unit(random) - 0.5, -1);
    world.lights.push_back(test::sun(direction, light, false));
    world.lights.back().intensity = 0.9;
    world.models.push_back(one_visual_model("plate", BoxShape{{2, 2, 0.2}}, at(0, 0, 0, 0, tilt), plain_material(diffuse)));
    Studio studio(world);
    const Image image = studio.picture(View::pinhole(looking_down(), 0.8, 64, 64));
    const Eigen::Vector3d normal(std::sin(tilt), 0, std::cos(tilt));
    const Eigen::Vector3d received = linear_of(world.scene.ambient) * (1 + 0.25 * normal.z()) +
                                     0.9 * std::max(0.0, -normal.dot(direction.normalized())) * Eigen::Vector3d(light.r, light.g, light.b);
    EXPECT_TRUE(is_near(pixel(image, 32, 32), linear_of(diffuse).cwiseProduct(toned(received)), 1.0)) << "sample " << i;
  }
}

// Eight lamps over the camera were the only ones, so all that was far from it was nearly black.
TEST(RenderLight, each_surface_is_lit_by_the_lamps_that_are_strongest_there) {
  WorldDef world = test::dark_world();
  LightDef lamp;
  lamp.kind = LightDef::Kind::point;
  lamp.diffuse = {1, 1, 1, 1};
  lamp.range = 8;
  lamp.constant_attenuation = 1;
  lamp.linear_attenuation = lamp.quadratic_attenuation = 0;
  for (int i = 0; i < 12; ++i) {
    lamp.pose = at(0, 0.1 * i, 20);
    lamp.range = 15;
    world.lights.push_back(lamp);
  }
  lamp.pose = at(0, 0, 1.1);
  lamp.range = 2;
  lamp.diffuse = {0.5F, 0.5F, 0.5F, 1};
  world.lights.push_back(lamp);
  world.models.push_back(one_visual_model("plate", BoxShape{{2, 2, 0.2}}, at(0, 0, 0), plain_material({1, 1, 1, 1})));
  Studio studio(world);
  View view = View::pinhole(looking_down(), 0.1, 64, 64);
  view.pose.translation().z() = 18;
  EXPECT_TRUE(is_near(pixel(studio.picture(view), 32, 32), {0.5, 0.5, 0.5}, 1.5));
}

// Where two floors are in one plane, each pixel was that of the one or the other.
TEST(RenderLight, a_floor_in_a_larger_ground_is_seen_everywhere) {
  WorldDef world = test::dark_world();
  world.scene.ambient = {0.8F, 0.8F, 0.8F, 1};
  world.models.push_back(one_visual_model("ground", PlaneShape{{0, 0, 1}, {200, 200}}, at(0, 0, 0), plain_material({0, 1, 0, 1})));
  world.models.push_back(one_visual_model("hall", BoxShape{{30, 30, 0.02}}, at(3, 2, -0.01, 0.3), plain_material({0, 0, 1, 1})));
  world.models.push_back(one_visual_model("room", BoxShape{{4, 4, 0.1}}, at(0, 0.7, -0.05, 0.7), plain_material({1, 0, 0, 1})));
  Studio studio(world);
  int red = 0, others = 0;
  for (double tilt : {0.15, 0.3, 0.6, 0.9}) {
    View view = View::pinhole(at(-6, 0.4, 6 * std::tan(tilt), 0.05, tilt), 0.25, 160, 120);
    const Image image = studio.picture(view);
    for (int y = 50; y < 70; ++y) {
      for (int x = 60; x < 100; ++x) {
        const auto p = pixel(image, x, y);
        (p[0] > 100 && p[1] < 20 && p[2] < 20 ? red : others) += 1;
      }
    }
  }
  EXPECT_EQ(others, 0) << red;
}

TEST(RenderLight, point_and_spot_lights_follow_their_reach) {
  WorldDef world = test::dark_world();
  LightDef lamp;
  lamp.kind = LightDef::Kind::point;
  lamp.pose = at(1, 0.5, 2);
  lamp.diffuse = {0.8F, 0.9F, 0.7F, 1};
  lamp.range = 20;
  lamp.constant_attenuation = 0.5;
  lamp.linear_attenuation = 0.1;
  lamp.quadratic_attenuation = 0.05;
  world.lights.push_back(lamp);
  LightDef spot = lamp;
  spot.kind = LightDef::Kind::spot;
  spot.pose = at(-0.5, 0, 3);
  spot.inner_angle = 0.3;
  spot.outer_angle = 0.9;
  spot.falloff = 1;
  world.lights.push_back(spot);
  world.models.push_back(one_visual_model("floor", PlaneShape{{0, 0, 1}, {20, 20}}, at(0, 0, 0), plain_material({0.9F, 0.9F, 0.9F, 1})));
  Studio studio(world);
  const Image image = studio.picture(View::pinhole(looking_down(), 1.2, 200, 200));
  const double focal = 100 / std::tan(0.6);
  for (const auto& [x, y] : {std::pair(100, 100), std::pair(40, 90), std::pair(120, 160), std::pair(100, 112), std::pair(10, 10)}) {
    // Looking down with yaw 0: the picture's up is x of the world, its left is y.
    const Eigen::Vector3d p(5 * (99.5 - y) / focal, 5 * (99.5 - x) / focal, 0);
    Eigen::Vector3d received(0, 0, 0);
    for (const auto& light : world.lights) {
      const Eigen::Vector3d to = light.pose.translation() - p;
      const double r = to.norm();
      double strength = 1 / (0.5 + 0.1 * r + 0.05 * r * r);
      if (light.kind == LightDef::Kind::spot) {
        const double cosine = to.z() / r;
        strength *= std::clamp((cosine - std::cos(0.45)) / (std::cos(0.15) - std::cos(0.45)), 0.0, 1.0);
      }
      received += strength * to.z() / r * Eigen::Vector3d(light.diffuse.r, light.diffuse.g, light.diffuse.b);
    }
    EXPECT_TRUE(is_near(pixel(image, x, y), toned(received) * decode(0.9), 1.5)) << x << ' ' << y;
  }
}

// A room of known paints below three lamps, as worlds of houses have them.
TEST(RenderLight, three_lamps_do_not_burn_out_a_room) {
  WorldDef world = dark_world();
  world.scene.ambient = {0.4F, 0.4F, 0.4F, 1};
  for (const double x : {-2.0, 0.0, 2.0}) {
    LightDef lamp;
    lamp.pose = at(x, 0, 2.6);
    lamp.diffuse = {0.8F, 0.8F, 0.8F, 1};
    lamp.range = 20;
    lamp.constant_attenuation = 0.5, lamp.linear_attenuation = 0.01, lamp.quadratic_attenuation = 0.001;
    world.lights.push_back(lamp);
  }
  const Color paints[] = {{0.9F, 0.9F, 0.88F, 1}, {0.6F, 0.6F, 0.6F, 1}, {0.8F, 0.3F, 0.2F, 1}, {0.2F, 0.4F, 0.7F, 1}};
  for (int i = 0; i < 4; ++i)
    world.models.push_back(
        one_visual_model("board" + std::to_string(i), BoxShape{{3, 1, 0.1}}, at(0, 1.5 - i, 0), plain_material(paints[i])));
  View view;
  view.is_parallel = true;
  view.pose = looking_down();
  view.left = -2, view.right = 2, view.bottom = -1.5, view.top = 1.5;
  view.width = 80, view.height = 60;
  const Image image = Studio(world).picture(view);
  int white = 0;
  for (int y = 0; y < view.height; ++y)
    for (int x = 0; x < view.width; ++x) white += pixel(image, x, y) == std::array<int, 3>{255, 255, 255} ? 1 : 0;
  EXPECT_EQ(white, 0);
  for (int i = 0; i < 4; ++i) {
    const auto seen = pixel(image, 10 + 20 * i, 30);
    for (std::size_t c = 0; c < 3; ++c) {
      const double paint = rgb(paints[i])[static_cast<Eigen::Index>(c)];
      EXPECT_GE(seen[c], 255 * paint - 2) << "board " << i;
      EXPECT_LE(seen[c], 255 * encode(1.2 * decode(paint)) + 1) << "board " << i;
    }
  }
}

TEST(RenderLight, fog_hides_what_is_far) {
  WorldDef world = test::dark_world();
  world.scene.fog = FogDef{"linear", {0.8F, 0.7F, 0.6F, 1}, 2, 10, 1};
  world.models.push_back(one_visual_model("wall", BoxShape{{0.1, 20, 20}}, at(6.05, 0, 0), glowing_material({0.2F, 0.3F, 0.9F, 1})));
  Studio studio(world);
  const Image image = studio.picture(View::pinhole(at(0, 0, 0), 0.8, 64, 64));
  const Eigen::Vector3d wall = linear_of({0.2F, 0.3F, 0.9F, 1}), fog = linear_of(world.scene.fog->color);
  EXPECT_TRUE(is_near(pixel(image, 32, 32), wall + 0.5 * (fog - wall), 1.0));
}

TEST(RenderLight, shining_surfaces_have_the_lobe_of_the_formula) {
  for (const float shininess : {1.0F, 2.0F, 7.0F, 10.0F, 32.0F, 12.5F, 200.0F}) {
    WorldDef world = dark_world();
    const Vector3d direction = Vector3d(0.3, 0.1, -1).normalized();
    world.lights.push_back(sun(direction, {0.3F, 0.3F, 0.3F, 1}, false));
    world.lights.back().specular = {0.7F, 0.8F, 0.9F, 1};
    MaterialDef material = plain_material({0.2F, 0.1F, 0.3F, 1});
    material.specular = {0.8F, 0.7F, 0.6F, 1};
    material.shininess = shininess;
    world.models.push_back(one_visual_model("floor", BoxShape{{20, 20, 0.2}}, at(0, 0, -0.1), material));
    Studio studio(world);
    const Image image = studio.picture(View::pinhole(looking_down(), 1.2, 200, 200));
    const double focal = 100 / std::tan(0.6);
    for (const auto& [x, y] : {std::pair(100, 100), std::pair(40, 90), std::pair(120, 30), std::pair(95, 160)}) {
      const Vector3d p(5 * (99.5 - y) / focal, 5 * (99.5 - x) / focal, 0), n(0, 0, 1);
      const Vector3d v = (Vector3d(0, 0, 5) - p).normalized(), l = -direction, h = (l + v).normalized();
      const Vector3d light = linear_of(material.diffuse) * 0.3 * n.dot(l) +
                             linear_of(material.specular).cwiseProduct(rgb(world.lights[0].specular)) * std::pow(n.dot(h), shininess);
      EXPECT_TRUE(is_near(pixel(image, x, y), light)) << "shininess " << shininess << " at " << x << ' ' << y;
    }
  }
}

TEST(RenderLight, lamps_shine_on_round_things_too) {
  WorldDef world = dark_world();
  LightDef lamp;
  lamp.kind = LightDef::Kind::point;
  lamp.pose = at(1, 1.5, 4);
  lamp.diffuse = {0.9F, 0.9F, 0.9F, 1};
  lamp.specular = {0.5F, 0.5F, 0.5F, 1};
  lamp.range = 20;
  lamp.constant_attenuation = 0.2, lamp.linear_attenuation = 0.1, lamp.quadratic_attenuation = 0.05;
  world.lights.push_back(lamp);
  MaterialDef material = plain_material({0.6F, 0.6F, 0.2F, 1});
  material.specular = {0.5F, 0.5F, 0.5F, 1};
  material.shininess = 20;
  world.models.push_back(one_visual_model("ball", SphereShape{1}, at(0, 0, 0), material));
  Studio studio(world);
  const Image image = studio.picture(View::pinhole(looking_down(), 0.5, 200, 200));
  const double focal = 100 / std::tan(0.25);
  for (const auto& [x, y] : {std::pair(100, 100), std::pair(70, 80), std::pair(120, 60), std::pair(60, 120)}) {
    const Vector3d eye(0, 0, 5), ray = Vector3d((99.5 - y) / focal, (99.5 - x) / focal, -1).normalized();
    const double b = ray.dot(eye), t = -b - std::sqrt(b * b - 24);
    const Vector3d p = eye + t * ray, n = p.normalized(), to = lamp.pose.translation() - p, l = to.normalized();
    const double r = to.norm(), strength = 1 / (0.2 + 0.1 * r + 0.05 * r * r);
    const Vector3d h = (l - ray).normalized();
    const Vector3d light = strength * (linear_of(material.diffuse) * 0.9 * std::max(0.0, n.dot(l)) +
                                       linear_of(material.specular) * 0.5 * std::pow(std::max(0.0, n.dot(h)), 20));
    EXPECT_TRUE(is_near(pixel(image, x, y), light, 4)) << x << ' ' << y;  // the ball has facets
  }
}

TEST(RenderLight, fog_lies_below_the_horizon_of_a_sky) {
  WorldDef world = test::dark_world();
  world.scene.sky = SkyDef{};
  world.scene.fog = FogDef{"exponential", {0.8F, 0.7F, 0.6F, 1}, 1, 100, 0.1};
  Studio studio(world);
  EXPECT_TRUE(is_near(pixel(studio.picture(View::pinhole(at(0, 0, 1, 0, 0.3), 0.4, 32, 32)), 16, 16), linear_of({0.8F, 0.7F, 0.6F, 1})));
  EXPECT_GT(pixel(studio.picture(View::pinhole(at(0, 0, 1, 0, -0.3), 0.4, 32, 32)), 16, 16)[2], 200) << "above it the sky is blue";
}

TEST(RenderLight, every_kind_of_fog_follows_its_formula) {
  for (const auto& [type, share] : {std::pair<const char*, double>("linear", (6 - 2) / 8.0),
                                    {"exponential", 1 - std::exp(-0.1 * 6)},
                                    {"quadratic", 1 - std::exp(-0.1 * 0.1 * 36)}}) {
    WorldDef world = dark_world();
    world.scene.fog = FogDef{type, {0.8F, 0.7F, 0.6F, 1}, 2, 10, 0.1};
    world.models.push_back(one_visual_model("wall", BoxShape{{0.1, 20, 20}}, at(6.05, 0, 0), glowing_material({0.2F, 0.3F, 0.9F, 1})));
    Studio studio(world);
    const Image image = studio.picture(View::pinhole(at(0, 0, 0), 0.8, 63, 63));
    const Vector3d wall = linear_of({0.2F, 0.3F, 0.9F, 1}), fog = linear_of(world.scene.fog->color);
    EXPECT_TRUE(is_near(pixel(image, 31, 31), wall + share * (fog - wall))) << type;
  }
}

// By the distance from the eye, not by the depth; a linear one neither before its start nor beyond all of it.
TEST(RenderLight, fog_counts_the_distance_of_each_pixel) {
  const Vector3d wall = linear_of({0.2F, 0.3F, 0.9F, 1}), fog = linear_of({0.8F, 0.7F, 0.6F, 1});
  for (const double depth : {1.0, 6.0, 30.0}) {
    WorldDef world = dark_world();
    world.scene.fog = FogDef{"linear", {0.8F, 0.7F, 0.6F, 1}, 2, 12, 0.1};
    world.models.push_back(
        one_visual_model("wall", BoxShape{{0.1, 200, 200}}, at(depth + 0.05, 0, 0), glowing_material({0.2F, 0.3F, 0.9F, 1})));
    const Image image = Studio(world).picture(View::pinhole(at(0, 0, 0), 1.6, 63, 63));
    const double focal = 31.5 / std::tan(0.8);
    for (const auto& [x, y] : {std::pair(31, 31), {2, 31}, {31, 60}, {3, 4}}) {
      const double distance = depth * std::hypot(1, (x - 31) / focal, (y - 31) / focal);
      const double share = std::clamp((distance - 2) / 10, 0.0, 1.0);
      EXPECT_TRUE(is_near(pixel(image, x, y), wall + share * (fog - wall))) << depth << " m, pixel " << x << ' ' << y;
    }
  }
}

TEST(RenderLight, light_goes_where_its_link_goes) {
  WorldDef world = dark_world();
  world.models.push_back(one_visual_model("floor", PlaneShape{{0, 0, 1}, {40, 40}}, at(0, 0, 0), plain_material({1, 1, 1, 1})));
  LightDef lamp;
  lamp.kind = LightDef::Kind::spot;
  lamp.pose = at(0.5, 0, 0);
  lamp.diffuse = {0.5F, 0.5F, 0.5F, 1};
  lamp.range = 20;
  lamp.constant_attenuation = 1, lamp.linear_attenuation = 0, lamp.quadratic_attenuation = 0;
  lamp.inner_angle = 0.4, lamp.outer_angle = 0.5, lamp.falloff = 1;
  ModelDef carrier = one_visual_model("carrier", BoxShape{{0.01, 0.01, 0.01}}, at(0, 0, 3), plain_material({0, 0, 0, 1}), false);
  carrier.links[0].lights.push_back(lamp);
  world.models.push_back(carrier);
  Studio studio(world);
  const View view = View::pinhole(at(0, 0, 8, 0, M_PI / 2), 1.0, 200, 200);
  const double focal = 100 / std::tan(0.5);
  const auto brightness = [&](const Image& image, double x, double y) {
    return pixel(image, static_cast<int>(100 - focal * y / 8), static_cast<int>(100 - focal * x / 8))[0];
  };
  const auto before = studio.picture(view);
  EXPECT_NEAR(brightness(before, 0.5, 0), 255 * encode(0.5), 2);
  EXPECT_EQ(brightness(before, -1, 2.5), 0);
  // A quarter turn takes the lamp from +x to +y of the carrier.
  studio.poses[1] = at(-1, 2, 3, M_PI / 2);
  const auto after = studio.picture(view);
  EXPECT_NEAR(brightness(after, -1, 2.5), 255 * encode(0.5), 2);
  EXPECT_EQ(brightness(after, 0.5, 0), 0);
}

TEST(RenderLight, lights_that_are_off_and_things_that_cast_no_shadow_do_nothing) {
  WorldDef world = dark_world();
  world.lights.push_back(sun({0, 0, -1}, {0.5F, 0.5F, 0.5F, 1}, true));
  world.lights.push_back(sun({0, 0, -1}, {0.5F, 0.5F, 0.5F, 1}, false));
  world.lights.back().is_on = false;
  world.models.push_back(one_visual_model("floor", PlaneShape{{0, 0, 1}, {40, 40}}, at(0, 0, 0), plain_material({1, 1, 1, 1})));
  world.models.push_back(one_visual_model("lid", BoxShape{{1, 1, 0.1}}, at(0, 0, 6), plain_material({1, 1, 1, 1})));
  const View view = View::pinhole(looking_down(), 0.8, 64, 64);
  EXPECT_EQ(pixel(Studio(world).picture(view), 32, 32)[0], 0);
  world.models[1].links[0].visuals[0].cast_shadows = false;
  EXPECT_TRUE(is_near(pixel(Studio(world).picture(view), 32, 32), Vector3d(0.5, 0.5, 0.5)));
  world.models[1].links[0].visuals[0].cast_shadows = true;
  world.scene.shadows = false;
  EXPECT_TRUE(is_near(pixel(Studio(world).picture(view), 32, 32), Vector3d(0.5, 0.5, 0.5)));
}

TEST(RenderLight, both_sides_of_a_double_sided_sheet_are_lit_from_their_own_side) {
  WorldDef world = dark_world();
  world.lights.push_back(sun({0, 0, -1}, {0.6F, 0.6F, 0.6F, 1}, true));
  world.lights.push_back(sun({0, 0, 1}, {0.3F, 0.3F, 0.3F, 1}, false));
  MaterialDef material = plain_material({1, 1, 1, 1});
  material.double_sided = true;
  world.models.push_back(one_visual_model("sheet", PlaneShape{{0, 0, 1}, {2, 2}}, at(0, 0, 1), material));
  Studio studio(world);
  EXPECT_TRUE(is_near(pixel(studio.picture(View::pinhole(looking_down(), 0.3, 32, 32)), 16, 16), Vector3d(0.6, 0.6, 0.6)));
  const View from_below = View::pinhole(at(0, 0, -3, 0, -M_PI / 2), 0.3, 32, 32);
  EXPECT_TRUE(is_near(pixel(studio.picture(from_below), 16, 16), Vector3d(0.3, 0.3, 0.3)));
  world.models[0].links[0].visuals[0].material->double_sided = false;
  EXPECT_EQ(pixel(Studio(world).picture(from_below), 16, 16)[0], 0);
}

TEST(RenderLight, transparent_things_mix_with_what_is_behind_in_the_order_of_their_distance) {
  WorldDef world = dark_world();
  const Color colors[3] = {{1, 0, 0, 0.5F}, {0, 1, 0, 0.25F}, {0, 0, 1, 0.75F}};
  // Defined in an order that is neither near to far nor far to near.
  for (const int i : {1, 0, 2}) {
    MaterialDef material = plain_material(colors[i]);
    material.lighting = false;
    world.models.push_back(one_visual_model("pane" + std::to_string(i), BoxShape{{0.01, 4, 4}}, at(2 + i, 0, 0), material));
  }
  world.models.push_back(one_visual_model("wall", BoxShape{{0.01, 9, 9}}, at(8, 0, 0), glowing_material({1, 1, 1, 1})));
  Studio studio(world);
  const Image image = studio.picture(View::pinhole(at(0, 0, 0), 0.5, 32, 32));
  Vector3d expected(255, 255, 255);
  for (const int i : {2, 1, 0}) expected += colors[i].a * (255 * rgb(colors[i]) - expected);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel(image, 16, 16)[static_cast<std::size_t>(c)], expected[c], 2) << c;
}

TEST(RenderLight, the_sky_goes_from_horizon_to_zenith_and_follows_the_hour) {
  const auto look_up = [](double time, double pitch) {
    WorldDef world = dark_world();
    world.scene.sky = SkyDef{time, 6, 20};
    return pixel(Studio(world).picture(View::pinhole(at(0, 0, 1, 0, -pitch), 0.3, 32, 32)), 16, 16);
  };
  const auto sum = [](const std::array<int, 3>& p) { return p[0] + p[1] + p[2]; };
  const auto zenith = look_up(12, 1.5), horizon = look_up(12, 0.1);
  EXPECT_GT(zenith[2], zenith[0] + 60);
  EXPECT_GT(sum(horizon), sum(zenith));
  const auto dusk = look_up(19.9, 0.1);
  EXPECT_GT(dusk[0], dusk[2]);
  EXPECT_LT(sum(look_up(23, 0.5)), 150);
}

TEST(RenderLight, only_the_strongest_lamps_are_used_when_there_are_many) {
  WorldDef world = dark_world();
  LightDef weak;
  weak.kind = LightDef::Kind::point;
  weak.pose = at(0, 0, 2);
  weak.diffuse = {0.001F, 0.001F, 0.001F, 1};
  weak.range = 20;
  weak.constant_attenuation = 1, weak.linear_attenuation = 0;
  for (int i = 0; i < 30; ++i) world.lights.push_back(weak);
  LightDef strong = weak;
  strong.diffuse = {0.5F, 0.5F, 0.5F, 1};
  world.lights.push_back(strong);
  world.models.push_back(one_visual_model("floor", PlaneShape{{0, 0, 1}, {40, 40}}, at(0, 0, 0), plain_material({1, 1, 1, 1})));
  EXPECT_TRUE(
      is_near(pixel(Studio(world).picture(View::pinhole(looking_down(), 0.1, 33, 33)), 16, 16), Vector3d::Constant(0.5 + 7 * 0.001)));
}

}  // namespace
}  // namespace sim

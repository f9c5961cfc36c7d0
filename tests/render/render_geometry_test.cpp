// Where things appear in a picture, and how far away: against the pinhole formula and against the ray caster.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "rays/ray_scene.h"
#include "render/camera.h"
#include "support/studio.h"

namespace sim {
namespace {

using namespace test;
using Eigen::Vector2d;
using Eigen::Vector3d;

// The middle of what glows, weighted by its light, in pixels from the upper left corner; empty when nothing does.
std::optional<Vector2d> middle_of_light(const Image& image) {
  Vector2d sum(0, 0);
  int count = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (pixel(image, x, y)[0] > 128) sum += Vector2d(x + 0.5, y + 0.5), ++count;
  if (count < 4) return std::nullopt;
  return sum / count;
}

WorldDef marker_world(const Vector3d& place, double radius) {
  WorldDef world = dark_world();
  world.models.push_back(
      one_visual_model("marker", SphereShape{radius}, at(place.x(), place.y(), place.z()), glowing_material({1, 1, 1, 1})));
  return world;
}

struct Pinhole {
  double fov;
  int width, height;
};

TEST(RenderGeometry, markers_appear_where_a_pinhole_camera_sees_them) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const Pinhole& lens : {Pinhole{1.2, 320, 240}, Pinhole{0.3, 320, 240}, Pinhole{2.0, 400, 300}, Pinhole{1.047, 640, 480},
                              Pinhole{0.8, 97, 211}, Pinhole{1.5, 1280, 720}}) {
    const double focal = 0.5 * lens.width / std::tan(0.5 * lens.fov);
    for (int i = 0; i < 8; ++i) {
      const Eigen::Isometry3d camera = at(3 * unit(random), 3 * unit(random), unit(random), 3 * unit(random), unit(random), unit(random));
      const double depth = 4 + 2 * unit(random);
      // Anywhere in the picture but at its very edge.
      const Vector2d wanted(0.5 * lens.width * (1 + 0.9 * unit(random)), 0.5 * lens.height * (1 + 0.9 * unit(random)));
      const Vector3d local(depth, -depth * (wanted.x() - 0.5 * lens.width) / focal, -depth * (wanted.y() - 0.5 * lens.height) / focal);
      // Three pixels: a larger ball far off the axis becomes an ellipse about another middle.
      Studio studio(marker_world(camera * local, 3 * depth / focal));
      const auto found = middle_of_light(studio.picture(View::pinhole(camera, lens.fov, lens.width, lens.height)));
      ASSERT_TRUE(found) << lens.width << 'x' << lens.height << " fov " << lens.fov << " at " << local.transpose();
      EXPECT_LT((*found - wanted).norm(), 0.5) << lens.width << 'x' << lens.height << " fov " << lens.fov << " at " << local.transpose();
    }
  }
}

TEST(RenderGeometry, markers_appear_where_an_off_centre_view_has_them) {
  View view = View::pinhole(at(0.5, -1, 1, 0.7, -0.2, 0.3), 1.0, 320, 240);
  // The axis leaves the picture at a quarter of its width and an eighth of its height from the upper left.
  const double wide = view.right - view.left, high = view.top - view.bottom;
  view.left = -0.25 * wide, view.right = 0.75 * wide;
  view.top = 0.125 * high, view.bottom = -0.875 * high;
  for (const Vector2d& wanted : {Vector2d(80, 30), Vector2d(300, 200), Vector2d(15, 220), Vector2d(250, 12)}) {
    const double depth = 5, scale = wide / 320;
    const Vector3d local(depth, -depth * (wanted.x() - 80) * scale, -depth * (wanted.y() - 30) * scale);
    Studio studio(marker_world(view.pose * local, 3 * depth * scale));
    const auto found = middle_of_light(studio.picture(view));
    ASSERT_TRUE(found);
    EXPECT_LT((*found - wanted).norm(), 0.5) << wanted.transpose();
  }
}

TEST(RenderGeometry, parallel_views_have_one_scale) {
  View view;
  view.is_parallel = true;
  view.pose = at(0, 0, 20, 0, M_PI / 2);
  view.width = 200, view.height = 100;
  view.left = -4, view.right = 4, view.bottom = -2, view.top = 2;
  for (const double height : {0.0, 10.0}) {
    // Up in the picture is x of the world, its left is y; 25 pixels a metre.
    Studio studio(marker_world({1, 2, height}, 0.2));
    const auto found = middle_of_light(studio.picture(view));
    ASSERT_TRUE(found);
    EXPECT_LT((*found - Vector2d(100 - 25 * 2, 50 - 25 * 1)).norm(), 0.5) << height;
  }
}

// A few of every shape, and a mesh, about the origin.
struct Thing {
  GeometryDef geometry;
  Eigen::Isometry3d pose;
};

std::vector<Thing> random_things(std::mt19937& random, const std::string& mesh) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Thing> things;
  const auto size = [&] { return 0.6 + 0.4 * unit(random); };
  for (int i = 0; i < 14; ++i) {
    const Eigen::Isometry3d pose = at(3 * unit(random), 3 * unit(random), 1 + unit(random), 3 * unit(random), unit(random), unit(random));
    GeometryDef geometry = BoxShape{{size(), size(), size()}};
    if (i % 7 == 1) geometry = SphereShape{0.5 + 0.3 * unit(random)};
    if (i % 7 == 2) geometry = CylinderShape{0.5 + 0.3 * unit(random), size()};
    if (i % 7 == 3) geometry = CapsuleShape{0.4 + 0.2 * unit(random), size()};
    if (i % 7 == 4) {
      MeshShape shape;
      shape.path = mesh;
      shape.scale = Vector3d(size(), -size(), size());
      geometry = shape;
    }
    if (i == 13) geometry = EllipsoidShape{{0.4, 0.9, 0.6}};
    if (i % 7 == 5) geometry = PolylineShape{{{{-0.5, -0.4}, {0.6, -0.3}, {0.2, 0.5}}}, size()};
    things.push_back({geometry, pose});
  }
  things.push_back({PlaneShape{{0, 0, 1}, {400, 400}}, at(0, 0, 0)});
  return things;
}

std::string write_wedge() {
  const auto file = std::filesystem::temp_directory_path() / ("render_geometry_" + std::to_string(::getpid()) + ".obj");
  std::ofstream(file) << "v -0.5 -0.5 -0.4\nv 0.5 -0.4 -0.4\nv 0 0.6 -0.4\nv 0.1 0 0.6\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  return file.string();
}

// The depths of the picture from that place against rays through the middles of pixels; edges of things are left out. How many pixels of
// things were compared.
int compare_with_rays(const std::vector<Thing>& things, const Eigen::Isometry3d& camera, int stride, const std::string& what) {
  WorldDef world = dark_world();
  TriangleCache triangles;
  RayScene rays(triangles);
  std::vector<std::string> notes;
  for (std::size_t i = 0; i < things.size(); ++i) {
    world.models.push_back(one_visual_model("t" + std::to_string(i), things[i].geometry, things[i].pose, plain_material({1, 1, 1, 1})));
    const RayShape shape{&things[i].geometry, Eigen::Isometry3d::Identity(), 0, 0};
    rays.add_static(std::span(&shape, 1), things[i].pose, notes);
  }
  rays.commit();
  EXPECT_TRUE(notes.empty());
  Studio studio(world);
  EXPECT_TRUE(studio.assets.take_complaints().empty());
  View view = View::pinhole(camera, 0.9, 320, 240);
  view.near_clip = 0.05;
  view.far_clip = 60;
  view.wants_exact_depth = true;
  const auto depth = studio.depth(view);
  const double focal = 160 / std::tan(0.45);
  const auto cast = [&](double x, double y) {
    const Vector3d ray(1, (160 - x) / focal, (120 - y) / focal);
    return rays.trace_one(camera.translation(), camera.linear() * ray.normalized(), 0.01F, 200).range / ray.norm();
  };
  int compared = 0, on_things = 0;
  for (int y = 1; y < 240; y += stride) {
    for (int x = 1; x < 320; x += stride) {
      const double expected = cast(x + 0.5, y + 0.5);
      bool is_edge = false;
      for (const auto& [dx, dy] : {std::pair(-0.6, 0.0), std::pair(0.6, 0.0), std::pair(0.0, -0.6), std::pair(0.0, 0.6)}) {
        const double beside = cast(x + 0.5 + dx, y + 0.5 + dy);
        is_edge = is_edge || !(std::abs(beside - expected) < 0.03 * expected || (beside > 60 && expected > 60));
      }
      if (is_edge) continue;
      const float got = depth[static_cast<std::size_t>(y * 320 + x)];
      ++compared;
      if (expected > 60) {
        EXPECT_TRUE(std::isinf(got)) << what << " pixel " << x << ' ' << y << ' ' << got;
      } else {
        EXPECT_NEAR(got, expected, 0.001 + 0.001 * expected) << what << " pixel " << x << ' ' << y;
        on_things += (camera * Vector3d(expected, (160 - x) / focal * expected, (120 - y) / focal * expected)).z() > 0.05;
      }
    }
  }
  EXPECT_GT(compared, 4000 / stride) << what;
  return on_things;
}

TEST(RenderGeometry, depth_agrees_with_the_ray_caster) {
  const std::string mesh = write_wedge();
  for (unsigned seed = 1; seed <= 5; ++seed) {
    std::mt19937 random(seed);
    EXPECT_GT(compare_with_rays(random_things(random, mesh), at(-7, 0.5, 2, 0.05, 0.15, 0.3), 5, "seed " + std::to_string(seed)), 100);
  }
  std::filesystem::remove(mesh);
}

// So near and large that a hundredth of the size is many pixels.
TEST(RenderGeometry, large_round_things_are_round_up_to_their_rims) {
  const GeometryDef shapes[] = {SphereShape{2}, CylinderShape{2, 1.5}, CapsuleShape{1.2, 2}, EllipsoidShape{{1, 2, 1.5}}};
  for (const auto& shape : shapes) {
    for (const auto& pose : {at(0, 0, 1), at(0, 0.3, 1, 0.5, 1.2, 0.4)}) {
      for (const auto& camera : {at(-4, 0, 3.5, 0, 0.6), at(-3.5, 2.5, 1, -0.8, 0.1)}) {
        const std::string what = "shape " + std::to_string(&shape - shapes);
        EXPECT_GT(compare_with_rays({{shape, pose}, {PlaneShape{{0, 0, 1}, {400, 400}}, at(0, 0, -3)}}, camera, 3, what), 300) << what;
      }
    }
  }
}

TEST(RenderGeometry, nothing_shows_before_the_near_and_behind_the_far_plane) {
  WorldDef world = dark_world();
  world.models.push_back(one_visual_model("near", BoxShape{{0.1, 4, 4}}, at(1, 0, 0), plain_material({1, 1, 1, 1})));
  world.models.push_back(one_visual_model("middle", BoxShape{{0.1, 4, 4}}, at(3, 0, 0), plain_material({1, 1, 1, 1})));
  Studio studio(world);
  View view = View::pinhole(at(0, 0, 0), 0.5, 32, 32);
  view.near_clip = 2;
  EXPECT_NEAR(studio.depth(view)[16 * 32 + 16], 2.95, 0.001);
  view.far_clip = 2.5;
  EXPECT_TRUE(std::isinf(studio.depth(view)[16 * 32 + 16]));
}

TEST(RenderGeometry, collisions_are_drawn_only_when_asked_for) {
  WorldDef world = dark_world();
  world.scene.ambient = {1, 1, 1, 1};
  ModelDef model = one_visual_model("m", SphereShape{0.2}, at(3, 0, 0), plain_material({0, 1, 0, 1}));
  CollisionDef collision;
  collision.name = "c";
  collision.geometry = BoxShape{{2, 2, 2}};
  model.links[0].collisions.push_back(collision);
  world.models.push_back(model);
  const View view = View::pinhole(at(0, 0, 0), 0.8, 64, 64);
  const auto visuals = Studio(world).picture(view);
  EXPECT_TRUE(is_bytes(pixel(visuals, 32, 32), {0, 255, 0}, 5));
  EXPECT_EQ(pixel(visuals, 50, 32), (std::array<int, 3>{0, 0, 0}));
  const auto collisions = Studio(world, shared_renderer(), Scene::Content::collisions).picture(view);
  EXPECT_EQ(pixel(collisions, 32, 32)[0], 255);
  EXPECT_EQ(pixel(collisions, 50, 32)[0], 255);
}

TEST(RenderGeometry, a_plane_that_bodies_stand_on_is_drawn_far_beyond_its_visual) {
  WorldDef world = dark_world();
  ModelDef model = one_visual_model("m", PlaneShape{{0, 0, 1}, {1, 1}}, at(0, 0, 0), plain_material({0, 1, 0, 1}));
  CollisionDef collision;
  collision.name = "c";
  collision.geometry = PlaneShape{};
  model.links[0].collisions.push_back(collision);
  world.models.push_back(model);
  const View view = View::pinhole(at(0, 0, 2, 0, 0.1, 0), 0.8, 64, 64);
  EXPECT_TRUE(std::isinf(Studio(world).depth(view)[60 * 64 + 32]));
  EXPECT_LT(Studio(world, shared_renderer(), Scene::Content::collisions).depth(view)[40 * 64 + 32], 20);
}

TEST(RenderGeometry, large_level_sheets_are_ground_and_cast_no_shadow) {
  WorldDef world = dark_world();
  const auto model = [&](const char* name, const Vector3d& size, double z) {
    world.models.push_back(one_visual_model(name, BoxShape{size}, at(0, 0, z), plain_material({1, 1, 1, 1})));
  };
  model("field", {200, 200, 0.01}, 0);
  model("roof", {30, 30, 0.01}, 4);
  model("table", {1, 1, 0.01}, 0.1);
  Studio studio(world);
  EXPECT_TRUE(studio.scene->drawables[0].is_ground);
  EXPECT_FALSE(studio.scene->drawables[1].is_ground);
  EXPECT_FALSE(studio.scene->drawables[2].is_ground);
  EXPECT_FALSE(studio.scene->drawables[0].has_grid);
}

}  // namespace
}  // namespace sim

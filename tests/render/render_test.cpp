// Pictures against geometry and the formula of light, computed here in double precision.
#include "render/renderer.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

#include "support/studio.h"

namespace sim {
namespace {

using namespace test;

// Distance along the ray to a box at the origin of `pose`, or infinity.
double ray_to_box(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction, const Eigen::Isometry3d& pose,
                  const Eigen::Vector3d& size) {
  const Eigen::Vector3d o = pose.inverse() * origin, d = pose.linear().transpose() * direction;
  double enter = 0, leave = infinite;
  for (int i = 0; i < 3; ++i) {
    const double a = (-0.5 * size[i] - o[i]) / d[i], b = (0.5 * size[i] - o[i]) / d[i];
    enter = std::max(enter, std::min(a, b));
    leave = std::min(leave, std::max(a, b));
  }
  return enter <= leave ? enter : infinite;
}

struct Box {
  Eigen::Isometry3d pose;
  Eigen::Vector3d size;
};

std::vector<Box> random_boxes(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) {
    boxes.push_back({at(4 * unit(random), 4 * unit(random), 0.8 + 0.6 * unit(random), 3 * unit(random), unit(random), unit(random)),
                     Eigen::Vector3d(0.7 + 0.4 * unit(random), 0.7 + 0.4 * unit(random), 0.7 + 0.4 * unit(random))});
  }
  return boxes;
}

double nearest(const std::vector<Box>& boxes, const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  double best = direction.z() < 0 ? -origin.z() / direction.z() : infinite;
  for (const auto& box : boxes) best = std::min(best, ray_to_box(origin, direction, box.pose, box.size));
  return best;
}

WorldDef world_of(const std::vector<Box>& boxes) {
  WorldDef world = test::dark_world();
  world.models.push_back(one_visual_model("ground", PlaneShape{{0, 0, 1}, {400, 400}}, at(0, 0, 0), plain_material({1, 1, 1, 1})));
  for (std::size_t i = 0; i < boxes.size(); ++i)
    world.models.push_back(
        one_visual_model("box" + std::to_string(i), BoxShape{boxes[i].size}, boxes[i].pose, plain_material({0.5F, 0.5F, 0.5F, 1}), false));
  return world;
}

TEST(Render, shadows_fall_where_rays_to_the_sun_are_blocked) {
  for (unsigned seed = 1; seed <= 2; ++seed) {
    std::mt19937 random(seed);
    const auto boxes = random_boxes(random, 10);
    WorldDef world = world_of(boxes);
    const Eigen::Vector3d direction = Eigen::Vector3d(0.5, -0.3, -1).normalized();
    world.lights.push_back(test::sun(direction, {0.8F, 0.8F, 0.8F, 1}, true));
    Studio studio(world);
    const Eigen::Isometry3d camera = at(0, 0, 14, 0, M_PI / 2);
    const Image image = studio.picture(View::pinhole(camera, 0.9, 300, 300));
    const double focal = 150 / std::tan(0.45);
    const auto blocked = [&](double x, double y) {
      double best = infinite;
      for (const auto& box : boxes) best = std::min(best, ray_to_box({x, y, 1e-6}, -direction, box.pose, box.size));
      return std::isfinite(best);
    };
    int shadowed = 0, lit = 0;
    for (int v = 2; v < 300; v += 5) {
      for (int u = 2; u < 300; u += 5) {
        const Eigen::Vector3d ray = camera.linear() * Eigen::Vector3d(1, (149.5 - u) / focal, (149.5 - v) / focal);
        const double along = nearest({}, camera.translation(), ray);
        if (nearest(boxes, camera.translation(), ray) < along) continue;
        const Eigen::Vector3d p = camera.translation() + along * ray;
        // Within two texels (2.5 cm) of an edge and the lift of the map either answer is right.
        const bool is_blocked = blocked(p.x(), p.y());
        bool is_edge = false;
        for (const auto& [dx, dy] : {std::pair(0.05, 0.0), std::pair(-0.05, 0.0), std::pair(0.0, 0.05), std::pair(0.0, -0.05)})
          is_edge = is_edge || blocked(p.x() + dx, p.y() + dy) != is_blocked;
        if (is_edge) continue;
        ++(is_blocked ? shadowed : lit);
        EXPECT_EQ(pixel(image, u, v)[0] < 40, is_blocked) << "seed " << seed << " at " << p.transpose() << " pixel " << u << ' ' << v;
      }
    }
    EXPECT_GT(shadowed, 40);
    EXPECT_GT(lit, 500);
  }
}

TEST(Render, shadows_of_moving_things_are_those_of_a_fresh_picture) {
  std::mt19937 random(3);
  WorldDef world = world_of(random_boxes(random, 8));
  world.models[3].is_static = world.models[4].is_static = true;
  world.lights.push_back(test::sun({0.5, -0.3, -1}, {0.8F, 0.8F, 0.8F, 1}, true));
  const auto renderer = open_renderer();
  Studio moving(world, *renderer);
  const View view = View::pinhole(at(-8, 0, 5, 0, 0.5), 1.0, 160, 120);
  (void)moving.picture(view);
  for (int step = 0; step < 8; ++step) {
    for (std::size_t i : {1, 2, 5}) moving.poses[i].translation() += Eigen::Vector3d(0.1, 0.07, 0.02);
    const Image image = moving.picture(view);
    Studio fresh(world);
    fresh.poses = moving.poses;
    EXPECT_EQ(image.rgba, fresh.picture(view).rgba) << "step " << step;
  }
  EXPECT_LT(moving.renderer->statistics().shadow_rebuilds, 5U) << "of 9 pictures";
}

// From one to the other end of what the sun's rays say.
TEST(Render, a_shadow_goes_where_its_thing_goes) {
  WorldDef world = world_of({{at(0, 0, 2), {1, 1, 0.2}}});
  world.lights.push_back(test::sun({1, 0, -1}, {0.8F, 0.8F, 0.8F, 1}, true));
  Studio studio(world);
  const View view = View::pinhole(at(2, 0, 10, 0, M_PI / 2), 1.0, 100, 100);
  const double focal = 50 / std::tan(0.5);
  const auto is_dark = [&](const Image& image, double x, double y) {
    return pixel(image, static_cast<int>(50 - focal * y / 10), static_cast<int>(50 - focal * (x - 2) / 10))[0] < 40;
  };
  const Image before = studio.picture(view);
  EXPECT_TRUE(is_dark(before, 2, 0));
  EXPECT_FALSE(is_dark(before, 2, 1.2));
  studio.poses[1].translation().y() = 1.1;
  (void)studio.picture(view);
  const auto rebuilds = studio.renderer->statistics().shadow_rebuilds;
  studio.poses[1].translation().y() = 1.2;
  // Not so far that the map is fitted anew.
  const Image after = studio.picture(view);
  EXPECT_FALSE(is_dark(after, 2, 0)) << "the old one stays";
  EXPECT_TRUE(is_dark(after, 2, 1.2));
  EXPECT_EQ(studio.renderer->statistics().shadow_rebuilds, rebuilds);
}

// A picture of everything first has all shadows in the map; the pictures after it must not differ from those that leave out what they can.
TEST(Render, only_shadows_that_nobody_sees_are_left_out) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(-1, 1);
  WorldDef world = world_of(random_boxes(random, 12));
  world.lights.push_back(test::sun({1, -0.6, -1}, {0.8F, 0.8F, 0.8F, 1}, true));
  const auto first = open_renderer(), second = open_renderer();
  Studio all(world, *first), some(world, *second);
  const View whole = View::pinhole(at(0, 0, 40, 0, M_PI / 2), 0.8, 32, 32);
  for (int round = 0; round < 25; ++round) {
    for (std::size_t i = 1; i < all.poses.size(); ++i) all.poses[i].translation() += 0.1 * Eigen::Vector3d(unit(random), unit(random), 0);
    some.poses = all.poses;
    (void)all.picture(whole);
    for (const double yaw : {0.0, 1.5, 3.0}) {
      const double z = 0.6 + unit(random) * 0.5;
      const View view = View::pinhole(at(3 * unit(random), 3 * unit(random), z, yaw + unit(random), 0.3 * (1 + unit(random))), 0.7, 80, 60);
      EXPECT_TRUE(all.picture(view).rgba == some.picture(view).rgba) << "round " << round << " yaw " << yaw;
    }
  }
  const auto drawn = [](const Studio& studio) { return studio.renderer->statistics().moving_shadows; };
  EXPECT_EQ(drawn(all), 25U * 12U) << "once for each place";
  EXPECT_LT(drawn(some), drawn(all));
}

TEST(Render, same_calls_make_the_same_bytes_in_any_thread) {
  std::mt19937 random(5);
  WorldDef world = world_of(random_boxes(random, 10));
  world.scene.sky = SkyDef{};
  world.lights.push_back(test::sun({0.5, -0.3, -1}, {0.8F, 0.8F, 0.8F, 1}, true));
  std::array<Image, 3> images;
  {
    std::vector<std::jthread> threads;
    for (auto& image : images)
      threads.emplace_back([&world, &image] {
        const auto renderer = open_renderer();
        Studio studio(world, *renderer);
        for (int i = 0; i < 3; ++i) image = studio.picture(View::pinhole(at(-8, 0.1 * i, 5, 0, 0.5), 1.0, 160, 120));
      });
  }
  EXPECT_EQ(images[0].rgba, images[1].rgba);
  EXPECT_EQ(images[0].rgba, images[2].rgba);
}

TEST(Render, what_carries_the_camera_and_is_not_in_its_view_is_not_drawn) {
  WorldDef world = test::dark_world();
  world.models.push_back(one_visual_model("carrier", BoxShape{{4, 1, 0.2}}, at(0, 0, 0.2, 0.3), plain_material({1, 1, 1, 1})));
  const auto renderer = open_renderer();
  Studio studio(world, *renderer);
  (void)studio.picture(View::pinhole(at(0, 0, 0, 0, M_PI / 2), 1.0, 64, 64));
  EXPECT_EQ(studio.renderer->statistics().drawn, 0U);
  (void)studio.picture(View::pinhole(at(0, 0, 0, 0, -M_PI / 2), 1.0, 64, 64));
  EXPECT_EQ(studio.renderer->statistics().drawn, 1U);
}

// Long things, of which a view often sees an end alone.
TEST(Render, what_reaches_into_the_view_is_drawn) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int round = 0; round < 40; ++round) {
    const Box box{at(4 + unit(random), 2 * unit(random), 2 * unit(random), 3 * unit(random), unit(random), unit(random)), {4, 0.4, 0.3}};
    WorldDef world = test::dark_world();
    world.models.push_back(one_visual_model("bar", BoxShape{box.size}, box.pose, glowing_material({1, 1, 1, 1})));
    Studio studio(world);
    for (int look = 0; look < 8; ++look) {
      const Eigen::Isometry3d camera = at(0, 0, 0, 0.8 * unit(random), 0.8 * unit(random), unit(random));
      const Image image = studio.picture(View::pinhole(camera, 0.3, 24, 24));
      const double focal = 12 / std::tan(0.15);
      int wrong = 0;
      for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 24; ++x) {
          const auto meets = [&](double dx, double dy) {
            return std::isfinite(ray_to_box(
                {0, 0, 0}, camera.linear() * Eigen::Vector3d(1, (11.5 - x + dx) / focal, (11.5 - y + dy) / focal), box.pose, box.size));
          };
          const bool is_whole = meets(-0.6, -0.6) && meets(0.6, -0.6) && meets(-0.6, 0.6) && meets(0.6, 0.6);
          wrong += is_whole && pixel(image, x, y)[0] != 255 ? 1 : 0;
        }
      }
      EXPECT_EQ(wrong, 0) << "round " << round << " look " << look;
    }
  }
}

TEST(Render, what_lies_outside_the_view_is_not_drawn) {
  WorldDef world = test::dark_world();
  for (int i = 0; i < 10; ++i)
    world.models.push_back(one_visual_model("b" + std::to_string(i), BoxShape{}, at(i < 4 ? 5 : -5, i, 0), plain_material({1, 1, 1, 1})));
  Studio studio(world);
  (void)studio.picture(View::pinhole(at(0, 0, 0), 2.2, 64, 64));
  EXPECT_EQ(studio.renderer->statistics().drawn, 4U);
  EXPECT_EQ(studio.renderer->statistics().culled, 6U);
}

TEST(Render, a_missing_texture_and_a_missing_mesh_are_named_and_shown_in_magenta) {
  WorldDef world = test::dark_world();
  world.scene.ambient = {1, 1, 1, 1};
  MaterialDef material = plain_material({1, 1, 1, 1});
  material.texture = "/nowhere/brick.png";
  world.models.push_back(one_visual_model("plate", BoxShape{{2, 2, 0.2}}, at(0, 0, 0), material));
  MeshShape mesh;
  mesh.path = "/nowhere/cow.dae";
  world.models.push_back(one_visual_model("cow", mesh, at(0, 3, 0), plain_material({0, 1, 0, 1})));
  Studio studio(world);
  const auto complaints = studio.assets.take_complaints();
  ASSERT_EQ(complaints.size(), 2U);
  EXPECT_NE(complaints[0].find("/nowhere/brick.png"), std::string::npos);
  EXPECT_NE(complaints[1].find("/nowhere/cow.dae"), std::string::npos);
  EXPECT_TRUE(studio.assets.take_complaints().empty());
  const Image image = studio.picture(View::pinhole(looking_down(), 1.4, 128, 128));
  int magenta = 0;
  for (int y = 0; y < 128; ++y)
    for (int x = 0; x < 128; ++x) {
      const auto p = pixel(image, x, y);
      magenta += p[0] > 200 && p[1] < 60 && p[2] > 200;
    }
  EXPECT_GT(magenta, 100);
}

TEST(Render, a_missing_mesh_is_drawn_as_what_bodies_meet_in_grey) {
  WorldDef world = test::dark_world();
  world.scene.ambient = {1, 1, 1, 1};
  MeshShape mesh;
  mesh.path = "/nowhere/shelf.dae";
  ModelDef model = one_visual_model("shelf", mesh, at(0, 0, 0), plain_material({0, 1, 0, 1}));
  CollisionDef collision;
  collision.geometry = BoxShape{{2, 2, 0.2}};
  model.links[0].collisions.push_back(collision);
  world.models.push_back(model);
  Studio studio(world);
  const Image image = studio.picture(View::pinhole(looking_down(), 0.2, 64, 64));
  const auto p = pixel(image, 5, 5);
  EXPECT_GT(p[0], 100);
  EXPECT_LT(std::abs(p[0] - p[1]) + std::abs(p[1] - p[2]), 20);
  EXPECT_EQ(pixel(image, 32, 32), p);
}

TEST(Render, a_notice_is_written_into_the_picture) {
  Studio studio(test::dark_world());
  Overlay overlay;
  overlay.notice = "nothing to show: 7 parts of this world are missing";
  overlay.is_notice_central = true;
  const auto lit_rows = [&] {
    const Image image = studio.picture(View::pinhole(looking_down(), 1.0, 300, 200), &overlay);
    std::vector<int> rows;
    for (int y = 0; y < 200; ++y) {
      int lit = 0;
      for (int x = 0; x < 300; ++x) lit += pixel(image, x, y)[0] > 150 ? 1 : 0;
      if (lit > 10) rows.push_back(y);
      EXPECT_LT(pixel(image, 2, y)[0] + pixel(image, 297, y)[0], 150) << "the line is longer than the picture";
    }
    return rows;
  };
  auto rows = lit_rows();
  ASSERT_FALSE(rows.empty());
  EXPECT_GT(rows.front(), 80);
  EXPECT_LT(rows.back(), 120);
  overlay.is_notice_central = false;
  rows = lit_rows();
  ASSERT_FALSE(rows.empty());
  EXPECT_GT(rows.front(), 160);
}

TEST(Render, a_texture_keeps_its_colours) {
  const auto file = std::filesystem::temp_directory_path() / ("render_test_texture_" + std::to_string(::getpid()) + ".png");
  Image texture{16, 16, {}};
  for (int i = 0; i < 256; ++i) texture.rgba.insert(texture.rgba.end(), {120, 33, 205, 255});
  ASSERT_TRUE(write_png(texture, file).ok());
  WorldDef world = test::dark_world();
  MaterialDef material = plain_material({1, 1, 1, 1});
  material.texture = file.string();
  material.lighting = false;
  world.models.push_back(one_visual_model("plate", BoxShape{{2, 2, 0.2}}, at(0, 0, 0), material));
  Studio studio(world);
  const Image image = studio.picture(View::pinhole(looking_down(), 0.3, 32, 32));
  std::filesystem::remove(file);
  EXPECT_TRUE(studio.assets.take_complaints().empty());
  EXPECT_TRUE(is_near(pixel(image, 16, 16), linear_of({120 / 255.0F, 33 / 255.0F, 205 / 255.0F, 1}), 1.0));
}

TEST(Render, impossible_views_are_refused) {
  Studio studio(test::dark_world());
  View view = View::pinhole(at(0, 0, 0), 1, 64, 64);
  view.far_clip = view.near_clip;
  EXPECT_FALSE(studio.renderer->draw(studio.scene, studio.poses, view).ok());
  view = View::pinhole(at(0, 0, 0), 1, 0, 64);
  EXPECT_FALSE(studio.renderer->draw(studio.scene, studio.poses, view).ok());
  view = View::pinhole(at(0, 0, NAN), 1, 64, 64);
  EXPECT_FALSE(studio.renderer->draw(studio.scene, studio.poses, view).ok());
  studio.poses.push_back(at(0, 0, 0));
  EXPECT_FALSE(studio.renderer->draw(studio.scene, studio.poses, View::pinhole(at(0, 0, 0), 1, 64, 64)).ok());
}

TEST(Render, overlays_show_fans_trails_and_names) {
  Studio studio(test::dark_world());
  Overlay overlay;
  overlay.fans.push_back({{0, 0, 0}, {{1, 1, 0}, {1, 0, 0}, {1, -1, 0}}, overlay_color(0)});
  overlay.trails.push_back({{{-1, -1, 0}, {-1, 1, 0}}, overlay_color(1), 3});
  overlay.labels.push_back({{-1.5, 0, 0}, 0.1, "robot", {1, 0, 0, 1}, 12});
  const Image image = studio.picture(View::pinhole(looking_down(), 1.0, 200, 200), &overlay);
  int blue = 0, green = 0, red = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const auto p = pixel(image, x, y);
      blue += p[2] > p[0] + 20 && p[2] > p[1] + 20;
      green += p[1] > p[0] + 40 && p[1] > p[2] + 40;
      red += p[0] > 200 && p[1] < 50;
    }
  EXPECT_GT(blue, 500);
  EXPECT_GT(green, 100);
  EXPECT_GT(red, 40);
}

// A name in the middle of a robot hid the robot, which is what a picture is made for.
TEST(Render, a_name_is_beside_what_it_names_and_off_all_others) {
  Overlay overlay;
  // Far from the edges; at the right edge; two close together; behind the camera.
  for (const auto& [x, y] : {std::pair{0.0, 0.0}, {0.0, -2.3}, {-1.0, 1.0}, {-0.8, 1.0}})
    overlay.labels.push_back({{x, y, 0}, 0.2, "pioneer2dx", {1, 1, 1, 1}, 12});
  overlay.labels.push_back({{0, 0, 100}, 0.2, "behind", {1, 1, 1, 1}, 12});
  View view = View::pinhole(looking_down(), 1.0, 600, 600);
  const auto places = label_places(overlay, view, 1);
  ASSERT_EQ(places.size(), 4U);
  const Eigen::AlignedBox2d picture(Eigen::Vector2d(0, 0), Eigen::Vector2d(600, 600));
  const double focal = 300 / std::tan(0.5), height = view.pose.translation().z();
  for (const auto& place : places) {
    EXPECT_TRUE(picture.contains(place.text)) << place.label;
    for (const auto& label : overlay.labels) {
      if (label.text == "behind") continue;
      const Eigen::Vector2d middle(300 - focal * label.at.y() / height, 300 - focal * label.at.x() / height);
      EXPECT_GT(place.text.exteriorDistance(middle), 0.7 * focal * 0.2 / height) << place.label;
    }
    for (const auto& other : places) {
      EXPECT_EQ(other.text.intersects(place.text), other.label == place.label) << other.label << " " << place.label;
    }
    EXPECT_GT((place.line_to - place.line_from).norm(), 5);
  }
}

TEST(Render, a_mesh_file_is_drawn_with_its_own_materials) {
  const auto folder = std::filesystem::temp_directory_path() / ("render_test_mesh_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "two.mtl") << "newmtl red\nKd 1 0 0\nnewmtl green\nKd 0 1 0\n";
  std::ofstream(folder / "two.obj") << "mtllib two.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
                                       "o left\nusemtl red\nf 1 2 3\no right\nusemtl green\nf 1 3 4\n";
  WorldDef world = test::dark_world();
  world.scene.ambient = {1, 1, 1, 1};
  MeshShape mesh;
  mesh.path = (folder / "two.obj").string();
  ModelDef model = one_visual_model("two", mesh, at(0, 0, 0), {});
  model.links[0].visuals[0].material.reset();
  world.models.push_back(model);
  Studio studio(world);
  const Image image = studio.picture(View::pinhole(looking_down(), 0.5, 64, 64));
  std::filesystem::remove_all(folder);
  // Up in the picture is +x, left is +y: the first triangle lies to the upper right.
  EXPECT_EQ(pixel(image, 50, 20), (std::array<int, 3>{255, 0, 0}));
  EXPECT_EQ(pixel(image, 20, 50), (std::array<int, 3>{0, 255, 0}));
}

// What a mesh names in its turn may be a pipe or a device, which would be read for ever.
TEST(Render, pipes_and_devices_that_a_mesh_names_are_not_read) {
  const auto folder = std::filesystem::temp_directory_path() / ("render_test_pipe_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const std::string triangle = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nvt 0 0\nusemtl skin\nf 1/1 2/1 3/1\n";
  std::ofstream(folder / "skin.mtl") << "newmtl skin\nmap_Kd /dev/zero\n";
  std::ofstream(folder / "texture.obj") << "mtllib skin.mtl\n" << triangle;
  std::ofstream(folder / "library.obj") << "mtllib pipe\n" << triangle;
  Assets assets;
  for (const char* name : {"texture.obj", "library.obj"}) {
    MeshShape mesh;
    mesh.path = (folder / name).string();
    EXPECT_NE(assets.mesh(mesh), nullptr) << name;
  }
  EXPECT_NE(assets.texture("/dev/zero"), nullptr);
  EXPECT_NE(assets.texture((folder / "pipe").string()), nullptr);
  int told = 0;
  for (const auto& line : assets.take_complaints()) told += line.find("is not a regular file") != std::string::npos;
  EXPECT_EQ(told, 2);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace sim

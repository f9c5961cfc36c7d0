// Bodies on height maps and meshes, and meshes that move: where they come to rest, and that a laser sees them there.
#include <gtest/gtest.h>
#include <png.h>

#include <numbers>

#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "support/world_files.h"

namespace sim {
namespace {

using namespace test;

// A cube of this side about its middle, and a body of two cubes, one on the other, as OBJ.
std::string cube_obj(double side, double z = 0, int first = 1) {
  const double h = side / 2;
  std::string text = "o cube" + std::to_string(first) + "\n";
  for (int i = 0; i < 8; ++i) {
    text += "v " + std::to_string((i & 1) != 0 ? h : -h) + " " + std::to_string((i & 2) != 0 ? h : -h) + " " +
            std::to_string(z + ((i & 4) != 0 ? h : -h)) + "\n";
  }
  for (const auto& f : {std::array{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
    text += "f";
    for (const int v : f) text += " " + std::to_string(v + first);
    text += "\n";
  }
  return text;
}

// Heights from a function of x and y (-1..1), 0..1, as a grey picture.
template <class Height>
std::string write_heights(const WorldFiles& files, int side, Height height) {
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
  for (int row = 0; row < side; ++row) {
    for (int column = 0; column < side; ++column) {
      const double x = 2.0 * column / (side - 1) - 1, y = 1 - 2.0 * row / (side - 1);
      pixels[static_cast<std::size_t>(row * side + column)] = static_cast<std::uint8_t>(std::lround(255 * height(x, y)));
    }
  }
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = image.height = static_cast<png_uint_32>(side);
  image.format = PNG_FORMAT_GRAY;
  const std::string path = (files.folder() / "heights.png").string();
  EXPECT_NE(png_image_write_to_file(&image, path.c_str(), 0, pixels.data(), 0, nullptr), 0);
  return path;
}

ModelDef falling(const std::string& name, const GeometryDef& shape, const Eigen::Isometry3d& pose) { return body(name, shape, pose, 2); }

class Meshes : public ::testing::Test {
 protected:
  MeshShape cube(double side) {
    MeshShape shape;
    shape.path = files_.write("cube" + std::to_string(side) + ".obj", cube_obj(side));
    return shape;
  }
  // With the inertia of a cube.
  ModelDef crate(const std::string& name, double side, const Eigen::Isometry3d& pose) {
    ModelDef model = body(name, BoxShape{{side, side, side}}, pose, 2);
    model.links[0].collisions[0].geometry = cube(side);
    return model;
  }
  WorldFiles files_;
};

TEST_F(Meshes, come_to_rest_on_a_plane_a_box_and_a_mesh_and_stay) {
  ModelDef table = fixed("mesh_table", BoxShape{}, at(6, 0, 0.5));
  table.links[0].collisions[0].geometry = cube(1);
  PhysicsFixture f(world_of({ground(), crate("on_plane", 0.4, at(0, 0, 0.5)), fixed("box_table", BoxShape{{1, 1, 1}}, at(3, 0, 0.5)),
                             crate("on_box", 0.4, at(3, 0, 1.4, 0.3)), table, crate("on_mesh", 0.4, at(6, 0, 1.4, 0.3)),
                             crate("lower", 0.6, at(9, 0, 0.31)), crate("upper", 0.4, at(9, 0, 0.9, 0.2)),
                             falling("box_on_crate", BoxShape{{0.3, 0.3, 0.3}}, at(9, 0, 1.3))}));
  ASSERT_TRUE(f.notes.empty()) << f.notes.front();
  f.run(10);
  const auto check = [&](const char* name, double x, double z) {
    EXPECT_NEAR(f.position(name).z(), z, 0.01) << name;
    EXPECT_LT((f.position(name).head<2>() - Eigen::Vector2d(x, 0)).norm(), 0.02) << name << " " << f.position(name).transpose();
    EXPECT_GT(f.physics.model_pose(f.id(name)).linear()(2, 2), 0.999) << name << " is upright";
  };
  check("on_plane", 0, 0.2);
  check("on_box", 3, 1.2);
  check("on_mesh", 6, 1.2);
  check("lower", 9, 0.3);
  check("upper", 9, 0.8);
  check("box_on_crate", 9, 1.15);
}

TEST_F(Meshes, balls_and_cans_rest_on_moving_meshes) {
  ModelDef crate_model = crate("crate", 1, at(0, 0, 0.5));
  crate_model.links[0].mass = 20;
  PhysicsFixture f(world_of({ground(), crate_model, falling("can", CylinderShape{0.1, 0.2}, at(0.2, 0.2, 1.2)),
                             falling("pill", CapsuleShape{0.1, 0.2}, tilted(-0.2, -0.2, 1.2, std::numbers::pi / 2, 0))}));
  f.run(5);
  EXPECT_NEAR(f.position("can").z(), 1.1, 0.01);
  EXPECT_NEAR(f.position("pill").z(), 1.1, 0.01);
  EXPECT_NEAR(f.position("crate").z(), 0.5, 0.01);
}

TEST_F(Meshes, a_fast_small_one_does_not_go_through_the_floor) {
  PhysicsFixture f(world_of({ground(), crate("pebble", 0.1, tilted(0, 0, 20, 0.4, 0.3)), crate("brick", 0.2, tilted(2, 0, 20, 0.1, 0.9))}));
  for (int i = 0; i < 80; ++i) {
    f.run(0.1);
    ASSERT_GT(f.position("pebble").z(), 0) << i;
    ASSERT_GT(f.position("brick").z(), 0) << i;
  }
  EXPECT_NEAR(f.position("pebble").z(), 0.05, 0.01);
  EXPECT_NEAR(f.position("brick").z(), 0.1, 0.01);
}

TEST_F(Meshes, that_move_are_seen_where_they_are) {
  ModelDef robot = body("eye", SphereShape{0.05}, at(0, 0, 0.5));
  robot.is_static = true;
  robot.links[0].sensors.push_back(laser("laser", 3, -0.01, 0.01, 10, Eigen::Isometry3d::Identity()));
  ModelDef crate_model = crate("crate", 1, at(4, 0, 0.5));
  crate_model.links[0].gravity = false;
  SimulationFixture f(world_of({robot, crate_model}));
  auto scan = f.open(shm::IfaceType::laser, "eye::laser");
  ASSERT_TRUE(f.simulation->physics().set_model_twist(1, {{-0.5, 0, 0}, {0, 0, 0}}));
  for (int i = 1; i <= 20; ++i) {
    f.run(0.1);
    ASSERT_TRUE(scan.read());
    ASSERT_NEAR(scan.laser_scan().ranges[1], f.simulation->physics().model_pose(1).translation().x() - 0.5, 0.001);
  }
}

// --- height maps

ModelDef terrain(const std::string& path, const Eigen::Vector3d& size, const Eigen::Isometry3d& pose, const Eigen::Vector3d& position) {
  HeightmapShape shape;
  shape.path = path;
  shape.size = size;
  shape.position = position;
  return fixed("terrain", shape, pose);
}

TEST_F(Meshes, bodies_rest_on_a_height_map_at_its_height_wherever_it_stands) {
  const std::string path = write_heights(files_, 65, [](double x, double) { return x < 0 ? 0.2 : 1.0; });
  PhysicsFixture f(world_of({terrain(path, {20, 10, 2}, at(3, -2, 1, 0.5), {1, 0.5, 0.25})}));
  const Eigen::Isometry3d place = at(3, -2, 1, 0.5) * Eigen::Translation3d(1, 0.5, 0.25);
  const auto put = [&](const char* name, const GeometryDef& shape, double x, double y, double height) {
    std::vector<std::string> notes;
    const Eigen::Vector3d p = place * Eigen::Vector3d(x, y, height + 0.6);
    ModelDef model = falling(name, shape, at(p.x(), p.y(), p.z()));
    ASSERT_TRUE(f.physics.spawn(std::make_shared<const ModelDef>(model), notes));
  };
  put("low_box", BoxShape{{0.4, 0.4, 0.4}}, -5, 2, 0.4);
  put("high_box", BoxShape{{0.4, 0.4, 0.4}}, 5, -2, 2);
  put("ball", SphereShape{0.2}, -7, -3, 0.4);
  put("can", CylinderShape{0.2, 0.4}, 7, 3, 2);
  put("mesh", cube(0.4), 6, 0, 2);
  EXPECT_LT((f.physics.shape_box(0).min() - Eigen::Vector3d(-9, -4.5, 0.65)).norm(), 1e-6) << f.physics.shape_box(0).min().transpose();
  EXPECT_LT((f.physics.shape_box(0).max() - Eigen::Vector3d(11, 5.5, 2.25)).norm(), 1e-6);
  EXPECT_LT((f.physics.shape_box(f.id("mesh")).max() - Eigen::Vector3d::Constant(0.2)).norm(), 1e-6);
  f.run(4);
  EXPECT_NEAR(f.position("low_box").z(), 1.25 + 0.4 + 0.2, 0.01);
  EXPECT_NEAR(f.position("high_box").z(), 1.25 + 2 + 0.2, 0.01);
  EXPECT_NEAR(f.position("ball").z(), 1.25 + 0.4 + 0.2, 0.01);
  EXPECT_NEAR(f.position("can").z(), 1.25 + 2 + 0.2, 0.01);
  EXPECT_NEAR(f.position("mesh").z(), 1.25 + 2 + 0.2, 0.01);
}

TEST_F(Meshes, a_height_map_is_the_same_for_bodies_and_for_lasers) {
  const std::string path = write_heights(files_, 33, [](double x, double y) { return 0.5 + 0.2 * std::sin(2 * x) + 0.25 * y; });
  std::vector<ModelDef> models{terrain(path, {16, 16, 4}, at(0, 0, 0), {0, 0, 0})};
  std::vector<Eigen::Vector2d> places{{0.3, 0.4}, {-3.1, 2.2}, {5.4, -4.7}, {2.05, 6.3}};
  for (std::size_t i = 0; i < places.size(); ++i) {
    // Its body stands a metre aside, where the ball does not come by.
    ModelDef eye =
        body("eye" + std::to_string(i), SphereShape{0.01}, tilted(places[i].x() + 1, places[i].y(), 10, 0, std::numbers::pi / 2));
    eye.is_static = true;
    eye.links[0].sensors.push_back(laser("laser", 1, 0, 0, 20, Eigen::Isometry3d(Eigen::Translation3d(0, 0, -1))));
    models.push_back(eye);
    // A small ball held over the same place, above the ray, free to move up and down only, rests where it touches the ground.
    ModelDef ball = body("ball" + std::to_string(i), SphereShape{0.02}, at(places[i].x(), places[i].y(), 10.5));
    JointDef rail;
    rail.name = "rail";
    rail.kind = JointDef::Kind::prismatic;
    rail.child = "link";
    rail.axes.push_back(AxisDef{});
    ball.joints.push_back(rail);
    models.push_back(ball);
  }
  SimulationFixture f(world_of(std::move(models)));
  std::vector<shm::Iface> eyes;
  for (std::size_t i = 0; i < places.size(); ++i) eyes.push_back(f.open(shm::IfaceType::laser, "eye" + std::to_string(i) + "::laser"));
  f.run(0.1);
  std::vector<double> seen;
  for (auto& eye : eyes) {
    ASSERT_TRUE(eye.read());
    seen.push_back(10 - eye.laser_scan().ranges[0]);
  }
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double x = places[i].x() / 8, y = places[i].y() / 8;
    EXPECT_NEAR(seen[i], 4 * (0.5 + 0.2 * std::sin(2 * x) + 0.25 * y), 0.02) << "8 bits of 4 m";
  }
  // The rays are of the start: afterwards the balls lie in them.
  f.run(4);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto ball = f.simulation->physics().find("ball" + std::to_string(i));
    const double slope = std::hypot(0.4 * std::cos(2 * places[i].x() / 8) / 2, 0.125);
    const double rest = seen[i] + 0.02 * std::sqrt(1 + slope * slope);
    EXPECT_NEAR(f.simulation->physics().model_pose(*ball).translation().z(), rest, 0.006) << i;
  }
}

TEST_F(Meshes, a_robot_drives_over_a_height_map_and_does_not_fall_through) {
  const std::string path = write_heights(files_, 65, [](double x, double y) { return 0.5 + 0.3 * std::cos(3 * x) * std::cos(3 * y); });
  SimulationFixture f(world_of({terrain(path, {40, 40, 2}, at(0, 0, -1.6), {0, 0, 0}), pioneer("robot", at(0, 0, 0.05))}, 0.002));
  auto drive = f.open(shm::IfaceType::position2d, "robot::position2d");
  ASSERT_TRUE(drive.command_velocity(0.5, 0, 0.05));
  for (int i = 0; i < 60; ++i) {
    f.run(0.5);
    const Eigen::Isometry3d pose = f.simulation->physics().model_pose(1);
    const Eigen::Vector3d p = pose.translation();
    const double ground = -1.6 + 2 * (0.5 + 0.3 * std::cos(3 * p.x() / 20) * std::cos(3 * p.y() / 20));
    ASSERT_NEAR(p.z(), ground, 0.04) << "after " << 0.5 * i << " s at " << p.transpose();
    ASSERT_GT(pose.linear()(2, 2), 0.9);
  }
}

}  // namespace
}  // namespace sim

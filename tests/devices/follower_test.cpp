// Models that follow way points in the running simulation: where they are, what they push aside, who may lead them away, resets.
#include <gtest/gtest.h>

#include <numbers>

#include "devices/device.h"
#include "devices/drives/path.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

PluginDef way(std::vector<std::string> waypoints) {
  PluginDef plugin;
  plugin.name = "gz::sim::systems::TrajectoryFollower";
  plugin.filename = "gz-sim-trajectory-follower-system";
  plugin.source = "test.sdf:7";
  ParameterNode list = node("waypoints", "");
  for (auto& text : waypoints) list.children.push_back(node("waypoint", text));
  plugin.parameters.children = {node("loop", "true"), node("speed", "1"), node("corner_radius", "0.5"), list};
  return plugin;
}

const std::vector<std::string> square{"0 0", "4 0", "4 4", "0 4"};

ModelDef walker() {
  ModelDef model = body("cow", BoxShape{{1, 0.5, 1}}, at(0, 0, 0.5), 100);
  model.plugins.push_back(way(square));
  return model;
}

WorldDef world_of(std::vector<ModelDef> models) {
  WorldDef world;
  world.physics.step = 0.001;
  world.models = std::move(models);
  return world;
}

void expect_on_path(const shm::Pose& pose, const Path& path, double t) {
  const Eigen::Isometry3d wanted = path.at(t);
  EXPECT_NEAR(pose.x, wanted.translation().x(), 1e-6) << "at " << t;
  EXPECT_NEAR(pose.y, wanted.translation().y(), 1e-6) << "at " << t;
  EXPECT_NEAR(pose.z, wanted.translation().z(), 1e-6) << "at " << t;
  EXPECT_NEAR(std::remainder(yaw_of(from_pose(pose)) - yaw_of(wanted), 2 * std::numbers::pi), 0, 1e-5) << "at " << t;
}

TEST(Follower, is_where_its_way_says_at_every_time_and_again_after_a_reset) {
  const auto path = Path::of(way(square), at(0, 0, 0.5));
  ASSERT_TRUE(path);
  SimulationFixture f(world_of({ground(), walker()}));
  auto cow = f.open(IfaceType::position3d, "cow::position3d");
  std::uint64_t hash = 0;
  for (int round : {1, 2}) {
    for (double t = 0.5; t < 1.5 * path->lap(); t += 0.5) {
      f.run(0.5);
      ASSERT_TRUE(cow.read());
      expect_on_path(cow.sample<shm::Position3dSample>().true_pose, *path, t);
      EXPECT_NEAR(cow.sample<shm::Position3dSample>().velocity[0], 1, 1e-3);
    }
    if (round == 1) {
      hash = f.simulation->hash();
      std::vector<std::string> notes;
      ASSERT_TRUE(f.simulation->reset(notes));
      f.times = {};
    } else {
      EXPECT_EQ(f.simulation->hash(), hash);
    }
  }
}

TEST(Follower, pushes_aside_what_is_in_its_way_and_is_not_moved_by_it) {
  const auto path = Path::of(way(square), at(0, 0, 0.5));
  SimulationFixture f(world_of({ground(), walker(), body("crate", BoxShape{{0.4, 0.4, 0.4}}, at(2, 0, 0.2), 20)}));
  auto cow = f.open(IfaceType::position3d, "cow::position3d");
  auto crate = f.open(IfaceType::truth, "crate");
  f.run(3);
  ASSERT_TRUE(cow.read());
  ASSERT_TRUE(crate.read());
  expect_on_path(cow.sample<shm::Position3dSample>().true_pose, *path, 3);
  EXPECT_GT(crate.sample<shm::TruthSample>().pose.x, 3.5) << "its front is at 3.5";
}

TEST(Follower, a_static_model_and_a_wrong_way_are_one_line_and_the_rest_runs) {
  ModelDef statue = fixed("statue", BoxShape{{1, 1, 1}}, at(9, 0, 0.5));
  statue.plugins.push_back(way(square));
  ModelDef lost = body("lost", BoxShape{{1, 1, 1}}, at(-9, 0, 0.5));
  lost.plugins.push_back(way({"1 x"}));
  SimulationFixture f(world_of({ground(), statue, lost, walker()}));
  ASSERT_EQ(f.dropped.size(), 2U);
  EXPECT_NE(f.dropped[0].find("static"), std::string::npos) << f.notes[0];
  EXPECT_NE(f.dropped[1].find("waypoint \"1 x\""), std::string::npos) << f.notes[1];
  auto cow = f.open(IfaceType::position3d, "cow::position3d");
  f.run(1);
  ASSERT_TRUE(cow.read());
  EXPECT_NEAR(cow.sample<shm::Position3dSample>().true_pose.x, 1, 1e-6);
}

TEST(Follower, a_helicopter_leaves_its_way_for_a_commander_and_returns_to_it) {
  ModelDef heli = body("heli", BoxShape{{1.5, 0.5, 0.5}}, at(0, 0, 5), 5);
  PluginDef drive;
  drive.name = "gz::sim::systems::VelocityControl";
  drive.filename = "gz-sim-velocity-control-system";
  heli.plugins = {way({"0 0 5", "4 0 5", "4 4 6", "0 4 5"}), drive};
  const auto path = Path::of(heli.plugins[0], at(0, 0, 5));
  SimulationFixture f(world_of({ground(), heli}));
  auto watch = f.open(IfaceType::position3d, "heli::position3d");
  f.run(2);
  ASSERT_TRUE(watch.read());
  expect_on_path(watch.sample<shm::Position3dSample>().true_pose, *path, 2);
  {
    auto commander = f.open(IfaceType::position3d, "heli::position3d");
    const double sideways[6] = {0, -1, 0.5, 0, 0, 0};
    ASSERT_TRUE(commander.command(shm::CommandKind::velocity, sideways));
    f.run(3);
    ASSERT_TRUE(watch.read());
    EXPECT_LT(watch.sample<shm::Position3dSample>().true_pose.y, -2);
    EXPECT_GT(watch.sample<shm::Position3dSample>().true_pose.z, 6);
  }
  f.run(20);  // back, and a good part of the round
  ASSERT_TRUE(watch.read());
  const auto pose = watch.sample<shm::Position3dSample>().true_pose;
  double nearest = 1e9;
  for (double t = 0; t < path->lap(); t += 0.001)
    nearest = std::min(nearest, (path->at(t).translation() - Eigen::Vector3d(pose.x, pose.y, pose.z)).norm());
  EXPECT_LT(nearest, 2e-3);
}

}  // namespace
}  // namespace sim

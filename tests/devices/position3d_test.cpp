// A body that flies by commands of a position3d: VelocityControl.
#include <gtest/gtest.h>

#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

WorldDef world_with(const ModelDef& model) {
  WorldDef world;
  world.physics.step = 0.001;
  world.models = {ground(), model};
  return world;
}

ModelDef helicopter() {
  ModelDef model = body("heli", BoxShape{{1.5, 0.5, 0.5}}, at(0, 0, 5), 5);
  PluginDef plugin;
  plugin.name = "gz::sim::systems::VelocityControl";
  plugin.filename = "gz-sim-velocity-control-system";
  model.plugins.push_back(plugin);
  return model;
}

TEST(Position3d, flies_as_told_and_holds_its_height) {
  SimulationFixture f(world_with(helicopter()));
  auto heli = f.open(IfaceType::position3d, "heli::position3d");
  const double hover[6] = {};
  ASSERT_TRUE(heli.command(shm::CommandKind::velocity, hover));
  f.run(2);
  ASSERT_TRUE(heli.read());
  EXPECT_NEAR(heli.sample<shm::Position3dSample>().true_pose.z, 5, 1e-3) << "it hovers";
  const double command[6] = {2, 0, 0.5, 0, 0, 0.3};
  ASSERT_TRUE(heli.command(shm::CommandKind::velocity, command));
  f.run(4);
  ASSERT_TRUE(heli.read());
  EXPECT_NEAR(heli.sample<shm::Position3dSample>().true_pose.z, 5 + 0.5 * (4 - 0.2), 0.02) << "it speeds up for 0.4 s";
  EXPECT_NEAR(heli.sample<shm::Position3dSample>().velocity[0], 2, 0.05);
  EXPECT_NEAR(heli.sample<shm::Position3dSample>().velocity[5], 0.3, 0.01);
  const double stop[6] = {};
  ASSERT_TRUE(heli.command(shm::CommandKind::velocity, stop));
  f.run(2);
  ASSERT_TRUE(heli.read());
  const double height = heli.sample<shm::Position3dSample>().true_pose.z;
  f.run(5);
  ASSERT_TRUE(heli.read());
  EXPECT_NEAR(heli.sample<shm::Position3dSample>().true_pose.z, height, 1e-3);
}

TEST(Position3d, describes_the_extent_of_its_body) {
  ModelDef model = helicopter();
  SimulationFixture f(world_with(model));
  const auto heli = f.open(IfaceType::position3d, "heli::position3d");
  const auto& info = heli.info<shm::Position3dInfo>();
  const Eigen::AlignedBox3d box = box_of(model, Eigen::Isometry3d::Identity());
  for (int i = 0; i < 3; ++i) EXPECT_DOUBLE_EQ(info.size[i], box.sizes()[i]);
  EXPECT_GT(info.size[0], 0);
  EXPECT_DOUBLE_EQ(info.pose.z, box.center().z());
}

TEST(Position3d, falls_until_the_first_command) {
  SimulationFixture f(world_with(helicopter()));
  auto heli = f.open(IfaceType::position3d, "heli::position3d");
  const auto height = [&] { return f.simulation->physics().model_pose(f.simulation->physics().find("heli").value()).translation().z(); };
  f.run(0.5);
  EXPECT_NEAR(height(), 5 - 9.8 * 0.25 / 2, 0.01) << "as any other body";
  std::vector<std::string> notes;
  ASSERT_TRUE(f.simulation->reset(notes));
  f.run(0.5);
  EXPECT_NEAR(height(), 5 - 9.8 * 0.25 / 2, 0.01) << "after a reset";
  f.run(3);
  EXPECT_NEAR(height(), 0.25, 0.01) << "it lies on the ground";
  const double up[6] = {0, 0, 1, 0, 0, 0};
  ASSERT_TRUE(heli.command(shm::CommandKind::velocity, up));
  f.run(3);
  EXPECT_GT(height(), 2);
}

}  // namespace
}  // namespace sim

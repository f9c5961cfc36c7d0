// A deleted model is restored as it was.
#include "server/deleted_models.h"

#include <gtest/gtest.h>

#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

constexpr const char* arm_that_falls = R"(<sdf version='1.9'><world name='w'>
  <model name='arm'><pose>1 2 5 0 0 0.3</pose>
    <link name='base'><inertial><mass>2</mass></inertial><collision name='c'><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision></link>
    <link name='tip'><pose>0.5 0 0 0 0 0</pose><inertial><mass>1</mass></inertial><collision name='c'><geometry><box><size>0.1 0.1 0.1</size></box></geometry></collision></link>
    <joint name='j' type='revolute'><pose relative_to='base'>0.2 0 0 0 0 0</pose><parent>base</parent><child>tip</child><axis><xyz>0 1 0</xyz></axis></joint>
  </model>
</world></sdf>)";

TEST(DeletedModels, a_model_that_flies_is_restored_with_its_pose_joints_and_velocities) {
  auto loaded = load_world_text(arm_that_falls, "/", "w", ModelPath{});
  ASSERT_TRUE(loaded) << loaded.error().message;
  test::SimulationFixture f(std::move(loaded->world));
  const auto id = *f.simulation->physics().find("arm");
  ASSERT_TRUE(f.simulation->physics().set_model_twist(id, {{1, 0, 2}, {0, 0, 0.5}}));
  ASSERT_TRUE(f.simulation->physics().add_wrench({id, 1}, {0, 0, 200}, {0, 0, 0}));
  f.run(0.3);
  const auto& before = f.simulation->physics();
  const auto pose = before.model_pose(id), tip = before.link_pose({id, 1});
  const auto twist = before.link_twist({id, 0}), tip_twist = before.link_twist({id, 1});
  const double angle = before.joint_state({id, 0}).position;
  ASSERT_GT(std::abs(angle), 0.01) << "the joint has turned";

  DeletedModels deleted;
  deleted.keep(f.simulation->physics(), id);
  f.simulation->remove(id);
  ASSERT_NE(deleted.find("arm"), nullptr);
  std::vector<std::string> notes;
  const auto again = f.simulation->spawn(*deleted.find("arm"), notes);
  ASSERT_TRUE(again) << again.error().message;
  const auto& after = f.simulation->physics();
  EXPECT_TRUE(after.model_pose(*again).isApprox(pose, 1e-9));
  EXPECT_TRUE(after.link_pose({*again, 1}).isApprox(tip, 1e-9));
  EXPECT_NEAR(after.joint_state({*again, 0}).position, angle, 1e-9);
  EXPECT_TRUE(after.link_twist({*again, 0}).linear.isApprox(twist.linear, 1e-9));
  EXPECT_TRUE(after.link_twist({*again, 0}).angular.isApprox(twist.angular, 1e-9));
  EXPECT_TRUE(after.link_twist({*again, 1}).linear.isApprox(tip_twist.linear, 1e-9));
}

TEST(DeletedModels, the_newest_of_a_name_is_found_and_the_oldest_of_many_forgotten) {
  auto loaded = load_world_text(arm_that_falls, "/", "w", ModelPath{});
  ASSERT_TRUE(loaded);
  test::SimulationFixture f(std::move(loaded->world));
  auto& physics = f.simulation->physics();
  const auto id = *physics.find("arm");
  DeletedModels deleted;
  EXPECT_EQ(deleted.find("arm"), nullptr);
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(physics.set_model_pose(id, Eigen::Isometry3d(Eigen::Translation3d(i, 0, 5))));
    deleted.keep(physics, id);
  }
  EXPECT_DOUBLE_EQ(deleted.find("arm")->pose.translation().x(), 39);
  deleted.clear();
  EXPECT_EQ(deleted.find("arm"), nullptr);
}

}  // namespace
}  // namespace sim

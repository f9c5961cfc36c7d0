// Many things at once: what lies still sleeps and wakes again, each group that touches has its own solver, and crowds stay within bounds.
#include <gtest/gtest.h>

#include <ctime>

#include "physics/solver_choice.h"
#include "support/heavy_worlds.h"
#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;

TEST(Crowd, what_lies_still_sleeps_after_a_moment) {
  PhysicsFixture f(resting_shapes(60));
  f.run(0.2);
  EXPECT_EQ(f.physics.statistics().awake, 0U);
  EXPECT_FALSE(f.physics.contacts(f.id("thing0")).empty()) << "it still touches the ground";
}

TEST(Crowd, what_must_not_sleep_does_not) {
  ModelDef box = body("box", BoxShape{{0.3, 0.3, 0.3}}, at(0, 0, 0.15));
  box.allow_auto_disable = false;
  PhysicsFixture f(world_of({ground(), box}));
  f.run(2);
  EXPECT_EQ(f.physics.statistics().awake, 1U);
}

TEST(Crowd, a_sleeping_box_wakes_when_it_is_hit_pushed_moved_or_loses_what_it_lies_on) {
  PhysicsFixture f(
      world_of({ground(), body("box", BoxShape{{0.3, 0.3, 0.3}}, at(0, 0, 0.15)), body("ball", SphereShape{0.1}, at(-2, 0, 0.1), 5),
                fixed("table", BoxShape{{1, 1, 1}}, at(5, 0, 0.5)), body("cup", CylinderShape{0.05, 0.1}, at(5, 0, 1.05))}));
  f.run(0.5);
  ASSERT_EQ(f.physics.statistics().awake, 0U);
  ASSERT_TRUE(f.physics.set_model_twist(f.id("ball"), {{3, 0, 0}, {0, 30, 0}}));
  f.run(1);
  EXPECT_GT(f.position("box").x(), 0.05);
  f.run(3);
  const double x = f.position("box").x();
  ASSERT_TRUE(f.physics.add_wrench(f.link("box"), {0, 1000, 0}, {0, 0, 0}));
  f.run(0.3);
  EXPECT_GT(f.position("box").y(), 0.01) << "x " << x;
  f.physics.remove(f.id("table"));
  f.run(1);
  EXPECT_LT(f.position("cup").z(), 0.2);
}

TEST(Crowd, a_slow_pendulum_does_not_stop_where_it_turns) {
  ModelDef pendulum = body("pendulum", SphereShape{0.1}, at(0, 0, 12));
  pendulum.links[0].pose = at(0.05, 0, -10);
  JointDef hinge;
  hinge.name = "hinge";
  hinge.kind = JointDef::Kind::continuous;
  hinge.child = "link";
  AxisDef axis;
  axis.xyz = {0, 1, 0};
  hinge.axes = {axis};
  pendulum.joints = {hinge};
  PhysicsFixture f(world_of({pendulum}));
  double least = 1, most = -1;
  for (int i = 0; i < 100; ++i) {
    f.run(0.1);
    least = std::min(least, f.physics.link_pose({0, 0}).translation().x());
    most = std::max(most, f.physics.link_pose({0, 0}).translation().x());
  }
  EXPECT_NEAR(least, -0.05, 0.005);
  EXPECT_NEAR(most, 0.05, 0.005);
}

TEST(Crowd, a_robot_of_49_links_holds_its_arms_and_rolls) {
  PhysicsFixture f(world_of({ground(), ManyLinks("robot", at(0, 0, 0)).model()}));
  const ModelId robot = f.id("robot");
  ASSERT_EQ(f.physics.def(robot).links.size(), 49U);
  for (std::uint32_t j = 0; j < f.physics.def(robot).joints.size(); ++j) {
    if (f.physics.def(robot).joints[j].name.find("caster") == std::string::npos) f.physics.set_motor({robot, j}, 0, 0, 3000);
  }
  const Eigen::Isometry3d hand = f.physics.link_pose(f.link("robot::base")).inverse() * f.physics.link_pose(f.link("robot::left9"));
  ASSERT_TRUE(f.physics.set_model_twist(robot, {{0.4, 0, 0}, {0, 0, 0}}));
  f.run(0.25);
  const Eigen::Isometry3d now = f.physics.link_pose(f.link("robot::base")).inverse() * f.physics.link_pose(f.link("robot::left9"));
  EXPECT_LT((now.translation() - hand.translation()).norm(), 0.005);
  EXPECT_NEAR(f.position("robot").z(), 0, 0.003);
  EXPECT_GT(f.position("robot").x(), 0.05) << "it rolls on";
  EXPECT_GT(f.physics.link_pose(f.link("robot::base")).linear()(2, 2), 0.999);
}

TEST(Crowd, what_a_heap_needs_changes_nothing_for_a_robot_beside_it) {
  const auto drive = [](bool has_heap) {
    std::vector<ModelDef> models{ground(), pioneer("robot", at(0, 0, 0))};
    for (int i = 0; has_heap && i < 4; ++i)
      models.push_back(body("box" + std::to_string(i), BoxShape{{0.3, 0.3, 0.3}}, at(0, 0.9, 0.15 + 0.3 * i)));
    PhysicsFixture f(world_of(std::move(models)));
    f.physics.set_motor({1, 0}, 0, 3, 1.5);
    f.physics.set_motor({1, 1}, 0, 3, 1.5);
    f.run(2);
    return f.position("robot");
  };
  EXPECT_EQ(drive(true), drive(false)) << "to the bit";
}

TEST(Crowd, a_humanoid_in_the_ground_is_solved_by_what_is_worth_its_work) {
  const auto solver = [](int bodies, double depth, PhysicsDef::Solver asked = PhysicsDef::Solver::automatic) {
    WorldDef world = world_of({ground(), humanoid(bodies, depth)});
    world.physics.solver = asked;
    PhysicsFixture f(std::move(world));
    f.run(0.002);
    return f.physics.last_solver(1);
  };
  EXPECT_EQ(solver(75, -1), StepSolver::tree) << "in the air";
  EXPECT_EQ(solver(75, 1.2), StepSolver::iterative) << "half in the ground";
  EXPECT_EQ(solver(8, -1), StepSolver::dense);
  EXPECT_EQ(solver(8, 1.2), StepSolver::dense) << "few bodies with few contacts";
  EXPECT_NE(solver(75, 1.2, PhysicsDef::Solver::exact), StepSolver::iterative) << "the world asks for it";
  EXPECT_EQ(solver(8, -1, PhysicsDef::Solver::iterative), StepSolver::iterative);
}

TEST(SolverChoice, goes_by_the_work_of_all_rows_and_not_by_contacts_alone) {
  const PhysicsDef physics;
  EXPECT_FALSE(choose_solver(physics, {.bodies = 1, .contact_rows = 60}).is_iterative) << "one body on many points";
  EXPECT_TRUE(choose_solver(physics, {.bodies = 1, .contact_rows = 600}).is_iterative);
  EXPECT_FALSE(choose_solver(physics, {.bodies = 75, .joint_rows = 370}).is_iterative) << "many joints alone";
  EXPECT_TRUE(choose_solver(physics, {.bodies = 75, .joint_rows = 370, .contact_rows = 180}).is_iterative) << "and what they touch";
  EXPECT_TRUE(choose_solver(physics, {.bodies = 5, .contact_rows = 12, .moving_contacts = 4}).is_iterative) << "a stack";
  EXPECT_TRUE(choose_solver(physics, {.bodies = 1, .contact_rows = 9, .is_ill_conditioned = true}).is_iterative)
      << "ODE would end the process";
  PhysicsDef many = physics;
  many.iterations = 500;
  EXPECT_FALSE(choose_solver(many, {.bodies = 75, .joint_rows = 370, .contact_rows = 180}).is_iterative) << "the other is no cheaper";
}

TEST(Crowd, many_in_one_place_touch_only_so_many_and_come_apart_gently) {
  std::vector<ModelDef> models{ground()};
  for (int i = 0; i < 60; ++i) models.push_back(body("box" + std::to_string(i), BoxShape{{0.3, 0.3, 0.3}}, at(0, 0, 0.15), 2));
  PhysicsFixture f(world_of(std::move(models), 0.005));
  f.run(0.01);
  EXPECT_LE(f.physics.statistics().contacts, 60U * (4 + 4)) << "one with each of four others, four with the ground";
  const auto all = [&] {
    Eigen::AlignedBox3d box;
    for (int i = 0; i < 60; ++i) box.extend(f.position("box" + std::to_string(i)));
    return box;
  };
  f.run(0.5);
  EXPECT_GT(all().sizes().maxCoeff(), 0.3);
  EXPECT_GT(all().min().z(), 0);
  f.run(2.5);
  EXPECT_GT(all().sizes().head<2>().minCoeff(), 0.6);
  EXPECT_LT(all().sizes().maxCoeff(), 6) << "nothing is thrown";
  EXPECT_GT(all().min().z(), 0.1);
}

TEST(Crowd, in_one_place_costs_a_time_that_grows_with_its_number) {
  const auto cost = [](int count) {
    std::vector<ModelDef> models{ground()};
    for (int i = 0; i < count; ++i) models.push_back(body("box" + std::to_string(i), BoxShape{{0.3, 0.3, 0.3}}, at(0, 0, 0.15), 2));
    PhysicsFixture f(world_of(std::move(models)));
    f.run(0.002);
    const std::clock_t start = std::clock();
    f.run(0.01);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  const double few = cost(60), many = cost(240);
  EXPECT_LT(many, 8 * few) << "of processor time: " << few << " s and " << many << " s";
}

TEST(Crowd, more_neighbours_than_count_are_told_once) {
  std::vector<ModelDef> models{ground()};
  for (int i = 0; i < 520; ++i)
    models.push_back(body("ball" + std::to_string(i), SphereShape{0.005}, at(0.011 * (i % 23), 0.011 * (i / 23), 0.005)));
  PhysicsFixture f(world_of(std::move(models), 0.01));
  f.run(0.03);
  const auto lines = f.physics.take_complaints();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_NE(lines[0].find("lies near more than 500 others"), std::string::npos) << lines[0];
}

TEST(Crowd, is_the_same_with_every_number_of_threads) {
  const auto hash = [](int threads) {
    WorldDef world = resting_shapes(24, 0.5);
    for (int i = 0; i < 6; ++i) world.models.push_back(pioneer("robot" + std::to_string(i), at(5 + 1.2 * i, 0, 0, 0.7 * i)));
    for (int i = 0; i < 5; ++i)
      world.models.push_back(body("box" + std::to_string(i), BoxShape{{0.3, 0.3, 0.3}}, at(-3, 0, 0.15 + 0.3 * i)));
    world.models.push_back(ManyLinks("many", at(-6, 0, 0)).model());
    PhysicsFixture f(std::move(world), threads);
    for (int i = 0; i < 6; ++i) {
      const ModelId robot = f.id("robot" + std::to_string(i));
      f.physics.set_motor({robot, 0}, 0, 3, 1.5);
      f.physics.set_motor({robot, 1}, 0, 2, 1.5);
    }
    f.run(0.3);
    return f.hash();
  };
  const auto one = hash(1);
  for (const int threads : {2, 3, 8}) EXPECT_EQ(hash(threads), one) << threads;
}

}  // namespace
}  // namespace sim

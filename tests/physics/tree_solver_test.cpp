// Models with many joints, whose joints are solved as a tree: beside ODE's own exact solver, which has them while they are fewer, and
// beside what mechanics says.
#include "physics/tree_solver.h"

#include <gtest/gtest.h>

#include <random>

#include "physics/bounded_system.h"
#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;

// A bar of eleven links that hangs from the world, or falls, with joints of all kinds, some with stops, friction and damping. With spare
// links beside it, which nothing touches, it has as many bodies as TreeSolver asks for.
ModelDef chain(unsigned seed, bool hangs, bool has_spares) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  ModelDef model;
  model.name = "chain";
  model.pose = at(0, 0, 5);
  model.canonical_link = "link0";
  model.allow_auto_disable = false;
  using Kind = JointDef::Kind;
  const Kind kinds[] = {Kind::revolute, Kind::prismatic, Kind::ball, Kind::continuous, Kind::fixed};
  for (int i = 0; i < 11; ++i) {
    LinkDef link = test::link("link" + std::to_string(i), BoxShape{{0.2, 0.1, 0.05}}, 0.5 + 0.2 * any(random), at(0.2 * i + 0.1, 0, 0));
    link.collisions.clear();
    model.links.push_back(link);
    if (i == 0 && !hangs) continue;
    JointDef joint;
    joint.name = "joint" + std::to_string(i);
    joint.kind = kinds[(i + seed) % 5];
    joint.parent = i == 0 ? "" : "link" + std::to_string(i % 3 == 2 ? i - 2 : i - 1);
    joint.child = link.name;
    if (i % 4 == 3) std::swap(joint.parent, joint.child);
    joint.provide_feedback = true;
    joint.pose_in_model = at(0.2 * i, 0, 0);
    AxisDef axis;
    axis.xyz = Eigen::Vector3d(any(random), any(random), any(random)).normalized();
    if (i % 2 == 0) axis.lower = -0.2, axis.upper = 0.1;
    if (i % 6 == 3) axis.friction = 0.05;
    if (i % 3 == 1) axis.damping = 0.02;
    joint.axes = {axis};
    model.joints.push_back(joint);
  }
  for (int i = 0; has_spares && i < 4; ++i)
    model.links.push_back(test::link("spare" + std::to_string(i), SphereShape{0.1}, 1, at(0, 50 + i, 0)));
  return model;
}

// Where the links are, and what the joints bear, after a while.
std::vector<Eigen::Vector3d> swing(const ModelDef& model, double seconds) {
  WorldDef world = world_of({model});
  PhysicsFixture f(std::move(world));
  for (std::uint32_t j = 0; j < f.physics.def(0).joints.size(); ++j) {
    // ODE does not tell what a motor bears at a stop.
    if (j % 3 == 1 && !std::isfinite(f.physics.def(0).joints[j].axes[0].upper)) f.physics.set_motor({0, j}, 0, 0.5, j % 2 == 0 ? 0.3 : 50);
  }
  f.run(seconds);
  std::vector<Eigen::Vector3d> out;
  for (std::uint32_t i = 0; i < 11; ++i) out.push_back(f.physics.link_pose({0, i}).translation());
  for (std::uint32_t j = 0; j < f.physics.def(0).joints.size(); ++j) {
    const auto load = f.physics.joint_load({0, j});
    if (load) out.push_back(load->force), out.push_back(load->torque);
  }
  return out;
}

TEST(TreeSolver, moves_joints_of_all_kinds_as_the_dense_solver_does) {
  for (const bool hangs : {true, false}) {
    for (unsigned seed = 0; seed < 5; ++seed) {
      const auto dense = swing(chain(seed, hangs, false), 0.2), tree = swing(chain(seed, hangs, true), 0.2);
      ASSERT_EQ(dense.size(), tree.size());
      EXPECT_GT((dense[10] - Eigen::Vector3d(2.1, 0, 5)).norm(), 0.02) << "it moves";
      for (std::size_t i = 0; i < dense.size(); ++i) {
        EXPECT_LT((dense[i] - tree[i]).norm(), i < 11 ? 1e-5 : 0.02 * std::max(1.0, dense[i].norm()))
            << "seed " << seed << (hangs ? ", hangs" : ", falls") << ", number " << i << ": " << dense[i].transpose() << " and "
            << tree[i].transpose();
      }
    }
  }
}

// A plate with a dozen small weights on it.
ModelDef sled(double mu) {
  ModelDef model = body("sled", BoxShape{{1, 1, 0.1}}, at(0, 0, 0.05), 10);
  model.allow_auto_disable = false;
  model.links[0].collisions[0].surface.mu = model.links[0].collisions[0].surface.mu2 = mu;
  for (int i = 0; i < 12; ++i) {
    const Eigen::Isometry3d place = at(-0.3 + 0.2 * (i % 4), -0.2 + 0.2 * (i / 4), 0.1);
    LinkDef weight = link("weight" + std::to_string(i), SphereShape{0.03}, 0.5, place);
    weight.collisions.clear();
    model.links.push_back(weight);
    JointDef joint;
    joint.name = "joint" + std::to_string(i);
    joint.parent = "link";
    joint.child = weight.name;
    joint.pose_in_model = place;
    AxisDef axis;
    axis.xyz = {0, 0, 1};
    joint.axes = {axis};
    joint.kind = JointDef::Kind::continuous;
    model.joints.push_back(joint);
  }
  return model;
}

TEST(TreeSolver, what_slides_is_slowed_down_as_coulomb_says_whatever_the_direction) {
  for (const double angle : {0.0, 0.5, M_PI / 4, 2.0}) {
    PhysicsFixture f(world_of({ground(), sled(0.4)}));
    f.run(0.05);
    const Eigen::Vector3d along(std::cos(angle), std::sin(angle), 0);
    ASSERT_TRUE(f.physics.set_model_twist(1, {2 * along, {0, 0, 0}}));
    const Eigen::Vector3d start = f.position("sled");
    f.run(0.3);
    const Eigen::Vector3d way = f.position("sled") - start;
    EXPECT_NEAR(way.dot(along), 2 * 0.3 - 0.5 * 0.4 * 9.8 * 0.3 * 0.3, 0.004) << angle;
    EXPECT_LT((way - along * way.dot(along)).norm(), 0.003) << angle;
    f.run(1);
    EXPECT_LT(f.physics.link_twist({1, 0}).linear.norm(), 1e-3) << "and stops";
  }
}

TEST(TreeSolver, contacts_bear_the_weight_and_tell_it) {
  PhysicsFixture f(world_of({ground(), sled(0.4)}));
  f.physics.record_forces(1);
  f.run(0.5);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  for (const auto& contact : f.physics.contacts(1)) force += contact.force;
  EXPECT_NEAR(force.z(), 16 * 9.8, 0.5);
  EXPECT_LT(force.head<2>().norm(), 0.1);
  EXPECT_NEAR(f.position("sled").z(), 0.05, 1e-3);
}

TEST(TreeSolver, pushes_what_is_in_its_way_and_is_stopped_by_walls) {
  ModelDef crate = body("crate", BoxShape{{0.4, 0.4, 0.4}}, at(0.9, 0, 0.2), 2);
  crate.links[0].collisions[0].surface.mu = crate.links[0].collisions[0].surface.mu2 = 0.1;
  PhysicsFixture f(world_of({ground(), sled(0.05), crate, fixed("wall", BoxShape{{0.1, 4, 1}}, at(2.5, 0, 0.5))}));
  ASSERT_TRUE(f.physics.set_model_twist(1, {{2, 0, 0}, {0, 0, 0}}));
  f.run(2);
  EXPECT_GT(f.position("crate").x(), 1.4);
  EXPECT_LT(f.position("crate").x(), 2.3);
  EXPECT_LT(f.position("sled").x() + 0.5, f.position("crate").x());
  EXPECT_NEAR(f.position("sled").z(), 0.05, 0.005);
}

TEST(TreeSolver, rides_on_what_moves_by_itself) {
  ModelDef belt = body("belt", BoxShape{{6, 6, 0.1}}, at(0, 0, 0.05), 10);
  belt.allow_auto_disable = false;
  ModelDef rider = sled(0.4);
  rider.pose = at(0, 0, 0.15);
  PhysicsFixture f(world_of({belt, rider}));
  ASSERT_TRUE(f.physics.make_kinematic(f.id("belt")));
  f.run(0.05);
  const Eigen::Vector3d start = f.position("sled");
  ASSERT_TRUE(f.physics.set_model_twist(f.id("belt"), {{0.5, 0, 0}, {0, 0, 0}}));
  f.run(1);
  EXPECT_NEAR(f.physics.link_twist(f.link("sled")).linear.x(), 0.5, 1e-3);
  // Friction brings it to the belt's speed in 0.5 / (0.4 * 9.8) seconds, in which it goes half as far.
  EXPECT_NEAR((f.position("sled") - start).x(), 0.5 - 0.5 * 0.5 * 0.5 / (0.4 * 9.8), 0.004);
  EXPECT_NEAR(f.position("sled").z(), 0.15, 1e-3);
}

TEST(TreeSolver, what_falls_among_things_stays_whole) {
  std::vector<ModelDef> models = {ground()};
  for (int i = 0; i < 9; ++i)
    models.push_back(body("crate" + std::to_string(i), BoxShape{{0.2, 0.2, 0.2}}, at(0.4 * (i % 3) - 0.4, 0.4 * (i / 3) - 0.4, 0.1), 1));
  ModelDef falling = sled(0.4);
  falling.pose = Eigen::Translation3d(0.15, 0.1, 0.9) * Eigen::AngleAxisd(0.4, Eigen::Vector3d(1, 0.5, 0).normalized());
  models.push_back(falling);
  PhysicsFixture f(world_of(std::move(models)));
  const ModelId id = f.id("sled");
  const auto place_in_plate = [&](std::uint32_t link) {
    return Eigen::Vector3d(f.physics.link_pose({id, 0}).inverse() * f.physics.link_pose({id, link}).translation());
  };
  std::vector<Eigen::Vector3d> before;
  for (std::uint32_t link = 0; link < 13; ++link) before.push_back(place_in_plate(link));
  std::uint32_t max_contacts = 0;
  for (int i = 0; i < 100; ++i) {
    f.run(0.02);
    max_contacts = std::max(max_contacts, f.physics.statistics().contacts);
    for (std::uint32_t link = 0; link < 13; ++link)
      ASSERT_LT((place_in_plate(link) - before[link]).norm(), 0.002) << i << ", link " << link;
    ASSERT_LT(f.physics.link_twist({id, 0}).linear.norm(), 6) << i << ": nothing throws it about";
  }
  EXPECT_GT(max_contacts, 9U * 4U) << "it has met the crates";
  EXPECT_LT(f.physics.link_twist({id, 0}).linear.norm(), 0.05) << "and lies";
  EXPECT_GT(f.position("sled").z(), 0.1) << "on them";
}

TEST(BoundedSystem, finds_what_keeps_the_bounds_and_leaves_over_only_what_they_allow) {
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  for (int round = 0; round < 50; ++round) {
    const Eigen::Index size = 1 + round % 24;
    BoundedSystem system;
    system.resize(size);
    const Eigen::MatrixXd part = Eigen::MatrixXd::NullaryExpr(size, std::max<Eigen::Index>(size / 2, 1), [&] { return any(random); });
    system.a = part * part.transpose() + 1e-6 * Eigen::MatrixXd::Identity(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      system.b[i] = any(random);
      system.low[i] = i % 3 == 0 ? 0 : -0.1;
      system.high[i] = i % 3 == 0 ? 1e300 : i % 3 == 1 ? 0.1 : -0.1;
    }
    ASSERT_TRUE(system.solve()) << round;
    const Eigen::VectorXd left = system.a * system.x - system.b;
    for (Eigen::Index i = 0; i < size; ++i) {
      EXPECT_GE(system.x[i], system.low[i] - 1e-6) << round;
      EXPECT_LE(system.x[i], system.high[i] + 1e-6) << round;
      EXPECT_TRUE(system.x[i] <= system.low[i] + 1e-9 || left[i] < 1e-5) << round;
      EXPECT_TRUE(system.x[i] >= system.high[i] - 1e-9 || left[i] > -1e-5) << round;
    }
  }
}

}  // namespace
}  // namespace sim

// Links of different models that are attached to each other.
#include <gtest/gtest.h>

#include "support/joint_rig.h"

namespace sim {
namespace {

using namespace test;

constexpr const char* weightless = "<gravity>0 0 0</gravity>";

std::string box(const std::string& name, const std::string& place, const std::string& more = {}, double mass = 1) {
  const std::string size = "<geometry><box><size>0.2 0.2 0.2</size></box></geometry>";
  return "<model name='" + name + "'><pose>" + place + " 0 0 0</pose>" + more + "<link name='body'>" + inertial("0 0 0 0 0 0", mass, mass) +
         "<collision name='c'>" + size + "</collision></link></model>";
}

// A hinge with a vertical axis, whose rod of 1 m begins at the origin.
const std::string turntable =
    "<model name='m'><pose>0 0 1 0 0 0</pose><allow_auto_disable>false</allow_auto_disable><link name='base'/><link name='arm'>" +
    inertial("0.5 0 0 0 0 0") +
    "</link><joint name='held' type='fixed'><parent>world</parent><child>base</child></joint><joint name='j' type='revolute'>"
    "<parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz></axis></joint></model>";

Eigen::Isometry3d apart(const PhysicsFixture& f, std::string_view a, std::string_view b) {
  return f.physics.link_pose(f.link(a)).inverse() * f.physics.link_pose(f.link(b));
}
double changed(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) { return (from.matrix() - to.matrix()).cwiseAbs().maxCoeff(); }

TEST(Weld, holds_two_bodies_as_they_were) {
  PhysicsFixture f(world_of_text(weightless + box("a", "0 0 1") + box("b", "1 0.5 1", "", 3)));
  const Eigen::Isometry3d before = apart(f, "a", "b");
  ASSERT_TRUE(f.physics.attach(f.link("a"), f.link("b")));
  EXPECT_TRUE(f.physics.are_attached(f.link("b"), f.link("a")));
  ASSERT_TRUE(f.physics.set_model_twist(f.id("a"), {{1, 0, 0}, {0, 0, 2}}));
  f.run(0.01);
  const auto momentum = [&] {
    return Eigen::Vector3d(f.physics.link_twist(f.link("a")).linear + 3 * f.physics.link_twist(f.link("b")).linear);
  };
  EXPECT_LT((momentum() - Eigen::Vector3d(1, 0, 0)).norm(), 1e-6);
  f.run(10);
  EXPECT_LT(changed(before, apart(f, "a", "b")), 1e-4);
  EXPECT_LT((momentum() - Eigen::Vector3d(1, 0, 0)).norm(), 1e-6);
}

TEST(Weld, is_a_part_of_an_arm_that_the_tree_solver_steps) {
  PhysicsFixture f(world_of_text(turntable + box("load", "1.3 0 1", "", 2)));
  ASSERT_TRUE(f.physics.attach(f.link("m::arm"), f.link("load")));
  const Eigen::Isometry3d before = apart(f, "m::arm", "load");
  for (int i = 0; i < 10000; ++i) {
    f.physics.set_row(f.joint("m", "j"), {.velocity = 1, .most = 1000});
    f.physics.step();
  }
  EXPECT_EQ(f.physics.last_solver(f.id("m")), StepSolver::tree);
  EXPECT_EQ(f.physics.last_solver(f.id("load")), StepSolver::tree);
  EXPECT_LT(changed(before, apart(f, "m::arm", "load")), 1e-3);
  EXPECT_NEAR(f.physics.link_twist(f.link("load")).angular.z(), 1, 1e-6);
  EXPECT_NEAR(f.position("load").head<2>().norm(), 1.3, 1e-3);
  EXPECT_NEAR(f.position("load").z(), 1, 1e-3);
}

// 1 N m on the rod of 0.04 + 0.25 kg m^2 and the load of 2 (0.04 + 1.69).
TEST(Weld, adds_the_inertia_of_what_it_holds) {
  for (const bool is_in_tree : {false, true}) {
    PhysicsFixture f(world_of_text(turntable + box("load", "1.3 0 1", "", 2)));
    ASSERT_TRUE(f.physics.attach(f.link("load"), f.link("m::arm")));
    for (int i = 0; i < 100; ++i) {
      if (is_in_tree) f.physics.set_row(f.joint("m", "j"), {.push = 1});
      if (!is_in_tree) {
        ASSERT_TRUE(f.physics.add_wrench(f.link("m::arm"), {0, 0, 0}, {0, 0, 1}));
      }
      f.physics.step();
    }
    EXPECT_NEAR(rate_of(f), 0.1 / (0.29 + 2 * 1.73), 1e-5) << is_in_tree;
  }
}

TEST(Weld, ends_by_detaching_and_with_either_model) {
  const auto falls = [](const auto& work) {
    PhysicsFixture f(
        world_of_text("<model name='post'><static>true</static><pose>0 0 3 0 0 0</pose><link name='l'/></model>" + box("load", "0 0 2")));
    EXPECT_TRUE(f.physics.attach(f.link("load"), f.link("post")));
    f.run(1);
    EXPECT_NEAR(f.position("load").z(), 2, 1e-4);
    work(f);
    const double start = f.position("load").z();
    f.run(0.2);
    return start - f.position("load").z() > 0.15;
  };
  EXPECT_FALSE(falls([](PhysicsFixture&) {}));
  EXPECT_TRUE(falls([](PhysicsFixture& f) { f.physics.detach(f.link("post"), f.link("load")); }));
  EXPECT_TRUE(falls([](PhysicsFixture& f) { f.physics.remove(f.id("post")); }));
  EXPECT_TRUE(falls([](PhysicsFixture& f) { f.physics.reset(); }));
  EXPECT_TRUE(falls([](PhysicsFixture& f) { f.physics.reset_poses(); }));
  Eigen::Isometry3d there = Eigen::Isometry3d::Identity();
  there.translation().z() = 5;
  EXPECT_TRUE(falls([&](PhysicsFixture& f) { ASSERT_TRUE(f.physics.set_model_pose(f.id("load"), there)); }));
  PhysicsFixture f(world_of_text(box("a", "0 0 2") + box("b", "1 0 2")));
  ASSERT_TRUE(f.physics.attach(f.link("a"), f.link("b")));
  f.physics.remove(f.id("b"));
  f.run(0.1);
  EXPECT_LT(f.position("a").z(), 2);
}

TEST(Weld, is_the_same_in_any_number_of_threads_however_far_apart) {
  std::string content;
  for (int i = 0; i < 24; ++i) content += box("box" + std::to_string(i), std::to_string(5 * i) + " 0 1");
  const auto hash_of = [&](int threads) {
    PhysicsFixture f(world_of_text(weightless + content), threads);
    EXPECT_GT(f.physics.statistics().shards, 4U);
    EXPECT_TRUE(f.physics.attach(f.link("box0"), f.link("box23")));
    EXPECT_TRUE(f.physics.attach(f.link("box11"), f.link("box23")));
    EXPECT_TRUE(f.physics.set_model_twist(f.id("box0"), {{0, 0, 1}, {0, 0, 0}}));
    f.run(1);
    EXPECT_GT(std::abs(f.position("box23").z() - 1), 0.05);
    EXPECT_LT(changed(apart(f, "box0", "box11"), Eigen::Isometry3d(Eigen::Translation3d(55, 0, 0))), 1e-2);
    return f.hash();
  };
  EXPECT_EQ(hash_of(1), hash_of(4));
}

TEST(Weld, sleeps_and_wakes_as_one) {
  const std::string floor =
      "<model name='floor'><static>true</static><link name='l'><collision "
      "name='c'><geometry><plane/></geometry></collision></link></model>";
  PhysicsFixture f(world_of_text(floor + box("a", "0 0 0.1") + box("b", "3 0 0.1")));
  ASSERT_TRUE(f.physics.attach(f.link("a"), f.link("b")));
  f.run(3);
  EXPECT_EQ(f.physics.statistics().awake, 0U);
  ASSERT_TRUE(f.physics.set_model_twist(f.id("a"), {{0, 0, 1}, {0, 0, 0}}));
  f.run(0.05);
  EXPECT_EQ(f.physics.statistics().awake, 2U);
  EXPECT_GT(f.position("b").z(), 0.101);
}

TEST(Weld, lets_what_it_holds_be_in_each_other) {
  PhysicsFixture f(world_of_text(weightless + box("a", "0 0 1") + box("b", "0.1 0 1")));
  ASSERT_TRUE(f.physics.attach(f.link("a"), f.link("b")));
  f.run(1);
  EXPECT_TRUE(f.physics.contacts(f.id("a")).empty());
  EXPECT_EQ(f.physics.link_twist(f.link("a")).linear.norm(), 0);
}

TEST(Weld, of_links_that_cannot_be_attached_is_refused_with_the_reason) {
  PhysicsFixture f(world_of_text(
      "<model name='p'><static>true</static><link name='l'/></model><model name='q'><static>true</static><link name='l'/></model>" +
      box("a", "0 0 2") + turntable));
  const auto reason = [&](std::string_view a, std::string_view b) {
    const auto done = f.physics.attach(f.link(a), f.link(b));
    return done ? "" : done.error().message;
  };
  EXPECT_EQ(reason("p", "q"), "neither p::l nor q::l can move");
  EXPECT_EQ(reason("m::arm", "m::base"), "m::arm and m::base are links of one model");
  EXPECT_EQ(reason("p", "a"), "");
  EXPECT_EQ(reason("a", "p"), "p::l and a::body are attached already");
}

TEST(Weld, changes_no_hash_of_a_world_without_one) {
  const auto hash_of = [](bool is_held) {
    PhysicsFixture f(world_of_text(box("a", "0 0 2") + box("b", "1 0 2")));
    if (is_held) {
      EXPECT_TRUE(f.physics.attach(f.link("a"), f.link("b")));
      f.physics.detach(f.link("a"), f.link("b"));
    }
    f.run(0.1);
    return f.hash();
  };
  EXPECT_EQ(hash_of(false), hash_of(true));
}

}  // namespace
}  // namespace sim

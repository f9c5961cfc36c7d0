// No contact of meshes adds energy: bodies dropped onto each other, and begun in each other; and they still rest, bounce and slide.
// A line for each drop: physics_test --gtest_filter='Pairs/*'
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "support/drops.h"

namespace sim {
namespace {

using namespace test;

// Two kinds of bodies, e.g. bowls, a lid and its box, thin plates: half-buried and from two heights, level and tilted, on what stands and
// on what is fixed.
class MeshEnergyOf : public ::testing::TestWithParam<std::size_t> {};

TEST_P(MeshEnergyOf, two_bodies_does_not_rise) {
  const auto [lower, upper] = drop_pairs()[GetParam()];
  for (const Drop& d : drops_of(lower, upper)) {
    const DropResult result = drop(d, 2);
    std::printf("%-60s gain %8.3f  lowest %6.3f  end (%6.3f %6.3f %6.3f)  speed %.4f\n", d.name.c_str(), result.gain, result.lowest,
                result.end.x(), result.end.y(), result.end.z(), result.speed);
    EXPECT_LT(result.gain, 0.01) << d.name << ": energy rises by " << 100 * result.gain << " %";
    EXPECT_GT(result.lowest, -0.02) << d.name;
  }
}

std::string name_of(const ::testing::TestParamInfo<std::size_t>& parameter) {
  const auto [lower, upper] = drop_pairs()[parameter.param];
  std::string name = upper.name + "_on_" + lower.name;
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Pairs, MeshEnergyOf, ::testing::Range<std::size_t>(0, drop_pairs().size()), name_of);

TEST(MeshEnergy, rises_by_no_more_than_a_force_has_done) {
  const Drop lid{"lid", open_box_outline(0.15, 0.2, 0.01), lid_outline(0.15, 0.03, 0.008), -0.015, 0, 0, 0.02};
  const DropResult result = drop(lid, 2, [](Physics& physics) {
    ASSERT_TRUE(physics.add_wrench({1, 0}, {1e-6, 0, 0}, Eigen::Vector3d::Zero()));
  });
  EXPECT_LT(result.gain, 0.01);
}

TEST(MeshEnergy, a_lid_lands_on_its_box_and_stays_there) {
  const Drop lid{"lid", open_box_outline(0.15, 0.2, 0.01), lid_outline(0.15, 0.03, 0.008), 0.05};
  const DropResult result = drop(lid, 2);
  EXPECT_NEAR(result.end.z(), 0.208, 0.001);
  EXPECT_LT(result.end.head<2>().norm(), 0.01);
  EXPECT_LT(result.speed, 0.001);
}

TEST(MeshEnergy, what_begins_in_another_comes_out_slowly_and_rests_on_it) {
  const Drop crate{"crate", crate_outline(0.15, 0.2), crate_outline(0.1, 0.12), -0.02};
  const DropResult result = drop(crate, 2);
  EXPECT_NEAR(result.end.z(), 0.2, 0.001);
  EXPECT_LT(result.gain, 0.01);
}

class MeshMotion : public ::testing::Test {
 protected:
  // A crate on a table, both meshes.
  PhysicsFixture over_table(double height, double tilt, const SurfaceDef& surface) {
    const Eigen::Isometry3d top = tilted(0, 0, 0, 0, tilt);
    ModelDef table = turned_body(files_, crate_outline(2, 0.5), "table", top * Eigen::Translation3d(0, 0, -0.5));
    table.is_static = true;
    ModelDef crate = turned_body(files_, crate_outline(0.1, 0.12), "crate", top * Eigen::Translation3d(0, 0, height));
    table.links[0].collisions[0].surface = crate.links[0].collisions[0].surface = surface;
    return PhysicsFixture(world_of({table, crate}));
  }
  WorldFiles files_;
};

TEST_F(MeshMotion, bounces_as_its_restitution_says) {
  SurfaceDef surface;
  surface.restitution = 0.7;
  surface.bounce_threshold = 0.01;
  PhysicsFixture f = over_table(0.5, 0, surface);
  double highest = 0;
  for (int i = 0; i < 800; ++i) {
    f.physics.step();
    if (f.physics.link_twist({1, 0}).linear.z() > 0) highest = std::max(highest, f.position("crate").z());
  }
  EXPECT_NEAR(highest, 0.5 * 0.49, 0.02);
}

TEST_F(MeshMotion, is_lifted_by_a_force) {
  PhysicsFixture f = over_table(0.0001, 0, SurfaceDef());
  f.run(0.2);
  const double mass = f.physics.def(1).links[0].mass, before = f.position("crate").z();
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(f.physics.add_wrench({1, 0}, {0, 0, 2 * 9.8 * mass}, Eigen::Vector3d::Zero()));
    f.physics.step();
  }
  EXPECT_NEAR(f.position("crate").z() - before, 0.5 * 9.8 * 0.04, 0.002);
}

TEST_F(MeshMotion, is_pushed_along_by_a_force) {
  SurfaceDef surface;
  surface.mu = surface.mu2 = 0.3;
  PhysicsFixture f = over_table(0.0001, 0, surface);
  f.run(0.2);
  const double mass = f.physics.def(1).links[0].mass;
  for (int i = 0; i < 400; ++i) {
    ASSERT_TRUE(f.physics.add_wrench({1, 0}, {0.5 * 9.8 * mass, 0, 0}, Eigen::Vector3d::Zero()));
    f.physics.step();
  }
  const double expected = 0.5 * (0.5 - 0.3) * 9.8 * 0.16;
  EXPECT_NEAR(f.position("crate").x(), expected, 0.03 * expected);
}

TEST_F(MeshMotion, slides_down_a_slope_as_its_friction_says) {
  SurfaceDef surface;
  surface.mu = surface.mu2 = 0.3;
  PhysicsFixture f = over_table(0.0001, 0.5, surface);
  f.run(0.5);
  const double expected = 0.5 * 9.8 * (std::sin(0.5) - 0.3 * std::cos(0.5)) * 0.25;
  EXPECT_NEAR(f.position("crate").norm(), expected, 0.03 * expected);
}

}  // namespace
}  // namespace sim

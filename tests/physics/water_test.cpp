// Floating, damping, added mass, wings: against closed formulas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <numbers>

#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;

// Water up to z = 0, nothing above.
const std::string pond =
    "<gravity>0 0 -9.81</gravity><plugin filename='gz-sim-buoyancy-system' name='gz::sim::systems::Buoyancy'><graded_buoyancy>"
    "<default_density>1000</default_density><density_change><above_depth>0</above_depth><density>0</density></density_change>"
    "</graded_buoyancy></plugin>";

std::string body(const std::string& name, double z, double mass, const Eigen::Vector3d& size, const std::string& more = "",
                 double roll = 0) {
  const Eigen::Vector3d s = size.cwiseAbs2();
  return fmt::format(
      "<model name='{}'><pose>0 0 {} {} 0 0</pose><link "
      "name='hull'><inertial><mass>{}</mass><inertia><ixx>{}</ixx><iyy>{}</iyy><izz>{}</izz>"
      "</inertia></inertial><collision name='c'><geometry><box><size>{} {} {}</size></box></geometry></collision></link>{}</model>",
      name, z, roll, mass, mass / 12 * (s.y() + s.z()), mass / 12 * (s.x() + s.z()), mass / 12 * (s.x() + s.y()), size.x(), size.y(),
      size.z(), more);
}

std::string hydrodynamics(const std::string& numbers, const std::string& name = "gz-sim-hydrodynamics-system") {
  return "<plugin filename='" + name + "' name='gz::sim::systems::Hydrodynamics'><link_name>hull</link_name>" + numbers + "</plugin>";
}

const std::string no_gravity = "<gravity>0 0 0</gravity>";

// Without damping it would heave for ever: the middle of its way, and how long one takes.
TEST(Boat, floats_at_a_quarter_of_a_metre_and_heaves_in_one_second) {
  PhysicsFixture f(world_of_text(pond + body("boat", 0.05 + 0.02, 500, {2, 1, 0.6})));
  std::vector<double> crossings;
  double sum = 0, before = f.position("boat").z() - 0.05;
  const int steps = 10030;
  for (int i = 0; i < steps; ++i) {
    f.physics.step();
    const double now = f.position("boat").z() - 0.05;
    sum += now;
    if (before < 0 && now >= 0) crossings.push_back((i + before / (before - now)) * 0.001);
    before = now;
  }
  EXPECT_NEAR(sum / steps, 0, 2e-4) << "its draught is 0.25 m";
  ASSERT_GE(crossings.size(), 9U);
  EXPECT_NEAR((crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1), 1.003, 0.001);
}

TEST(Boat, rights_itself_when_its_metacentre_is_above_its_weight) {
  const std::string damped = hydrodynamics("<kP>-200</kP><mQ>-200</mQ><zW>-2000</zW>");
  PhysicsFixture wide(world_of_text(pond + body("boat", 0.05, 500, {2, 1, 0.6}, damped, 0.3)));
  wide.run(20);
  EXPECT_LT(std::abs(wide.physics.model_pose(0).linear()(2, 1)), 1e-3);
  EXPECT_NEAR(wide.position("boat").z(), 0.05, 1e-4);
  // A high narrow one lies down.
  PhysicsFixture narrow(world_of_text(pond + body("boat", 0.0, 500, {1, 0.5, 2}, damped, 0.05)));
  narrow.run(20);
  EXPECT_LT(std::abs(narrow.physics.model_pose(0).linear()(2, 2)), 0.5);
}

// Its middle is 0.3 m above the keel; BM = B^2 / (12 d) = 0.333 m, so that GM = 0.125 + 0.333 - 0.3 = 0.158 m.
TEST(Boat, is_righted_by_its_weight_at_the_arm_of_its_metacentre) {
  constexpr double roll = 0.01, metacentre = 0.25 / 2 + 1.0 / (12 * 0.25) - 0.3;
  PhysicsFixture f(world_of_text(pond + body("boat", 0.05, 500, {2, 1, 0.6}, "", roll)));
  f.run(0.01);
  const double inertia = 500.0 / 12 * (1 + 0.36);
  EXPECT_NEAR(f.physics.link_twist(f.link("boat")).angular.x() / 0.01, -500 * 9.81 * metacentre * roll / inertia, 0.002);
}

TEST(Boat, that_nobody_damps_keeps_its_energy) {
  PhysicsFixture f(world_of_text(pond + body("boat", 0.15, 500, {2, 1, 0.6})));
  double highest = 0;
  f.run(60);
  for (int i = 0; i < 2000; ++i) f.physics.step(), highest = std::max(highest, f.position("boat").z());
  EXPECT_NEAR(highest, 0.15, 2e-3);
}

TEST(Submarine, of_the_weight_of_its_water_stays_and_a_light_one_rises_without_falling_asleep) {
  const std::string uniform =
      "<gravity>0 0 -9.81</gravity><plugin filename='gz-sim-buoyancy-system' name='gz::sim::systems::Buoyancy'>"
      "<uniform_fluid_density>1000</uniform_fluid_density></plugin>";
  PhysicsFixture still(world_of_text(uniform + body("sub", -5, 1000, {1, 1, 1})));
  still.run(10);
  EXPECT_NEAR(still.position("sub").z(), -5, 1e-6);
  PhysicsFixture light(world_of_text(uniform + body("sub", -5, 999.9, {1, 1, 1})));
  light.run(10);
  EXPECT_NEAR(light.position("sub").z(), -5 + 0.5 * (0.1 / 999.9 * 9.81) * 100, 1e-3);
}

TEST(Hydrodynamics, linear_and_quadratic_drag_leave_one_metre_a_second_of_fifty_newtons) {
  PhysicsFixture f(world_of_text(no_gravity + body("sub", 0, 50, {1, 1, 1}, hydrodynamics("<xU>-20</xU><xUabsU>-30</xUabsU>"))));
  for (int i = 0; i < 20000; ++i) {
    ASSERT_TRUE(f.physics.add_wrench(f.link("sub"), {50, 0, 0}, {0, 0, 0}));
    f.physics.step();
  }
  EXPECT_NEAR(f.physics.link_twist(f.link("sub")).linear.x(), 1, 1e-6);
}

TEST(Hydrodynamics, a_current_takes_the_body_along) {
  PhysicsFixture f(world_of_text(
      no_gravity + body("sub", 0, 5, {1, 1, 1}, hydrodynamics("<xU>-20</xU><yV>-20</yV><default_current>0.5 -1 0</default_current>"))));
  f.run(5);
  EXPECT_TRUE(f.physics.link_twist(f.link("sub")).linear.isApprox(Eigen::Vector3d(0.5, -1, 0), 1e-6));
}

// Added mass far larger than the mass makes gz-sim's finite difference explode; a body of the sum of both is what it must be.
TEST(Hydrodynamics, added_mass_is_a_mass_however_large) {
  for (const double added : {30.0, 50.0, 500.0, 50000.0}) {
    PhysicsFixture f(world_of_text(no_gravity + body("sub", 0, 50, {1, 1, 1}, hydrodynamics(fmt::format("<xDotU>-{}</xDotU>", added)))));
    for (int i = 0; i < 1000; ++i) {
      ASSERT_TRUE(f.physics.add_wrench(f.link("sub"), {50, 0, 0}, {0, 0, 0}));
      f.physics.step();
    }
    EXPECT_NEAR(f.physics.link_twist(f.link("sub")).linear.x() * (50 + added) / 50, 1, 0.002) << added;
  }
}

// The inertial's y is the link's x, backwards.
TEST(Hydrodynamics, added_mass_of_an_inertial_is_the_same) {
  for (const Eigen::Vector3d& force : {Eigen::Vector3d(200, 0, 0), Eigen::Vector3d(0, 0, 250)}) {
    PhysicsFixture f(world_of_text(no_gravity +
                                   "<model name='sub'><link name='hull'><inertial><pose>0.2 0 0 0 0 1.5707963</pose><mass>50</mass>"
                                   "<fluid_added_mass><xx>30</xx><yy>150</yy><zz>200</zz></fluid_added_mass></inertial></link></model>"));
    for (int i = 0; i < 1000; ++i) {
      ASSERT_TRUE(f.physics.add_wrench(f.link("sub"), force, {0, 0, 0}));
      f.physics.step();
    }
    const Twist twist = f.physics.link_twist(f.link("sub"));
    EXPECT_NEAR(twist.linear.norm(), 1, 0.005);
    EXPECT_LT(twist.angular.norm(), 0.01) << "it is pushed at its middle";
  }
}

// A body with different added masses that drifts obliquely is turned by the water across its way (Munk), and its energy stays.
TEST(Hydrodynamics, coriolis_forces_of_added_mass_do_no_work) {
  const std::string numbers =
      "<xDotU>-20</xDotU><yDotV>-120</yDotV><zDotW>-120</zDotW><kDotP>-1</kDotP><mDotQ>-30</mDotQ><nDotR>-30</nDotR>";
  PhysicsFixture f(world_of_text(no_gravity + body("sub", 0, 100, {2, 0.5, 0.5}, hydrodynamics(numbers))));
  ASSERT_TRUE(f.physics.set_model_twist(0, {{1, 0.3, 0}, {0, 0, 0}}));
  const auto energy = [&] {
    const Eigen::Matrix3d into = f.physics.model_pose(0).linear().transpose();
    const Twist twist = f.physics.link_twist(f.link("sub"));
    const Eigen::Vector3d v = into * twist.linear, w = into * twist.angular;
    const double ixx = 100.0 / 12 * 0.5, iyy = 100.0 / 12 * 4.25;
    return 0.5 * (v.cwiseAbs2().dot(Eigen::Vector3d(120, 220, 220)) + w.cwiseAbs2().dot(Eigen::Vector3d(ixx + 1, iyy + 30, iyy + 30)));
  };
  f.run(0.01);
  const double start = energy();
  double max_turn = 0;
  for (int i = 0; i < 20000; ++i) {
    f.physics.step();
    max_turn = std::max(max_turn, std::abs(f.physics.link_twist(f.link("sub")).angular.z()));
  }
  EXPECT_GT(max_turn, 0.1);
  EXPECT_NEAR(energy() / start, 1, 0.005);
}

// A slender hull with a fin behind, as auv_controls.sdf of gz-sim has it: the water that it takes along across its way turns it off its
// course (Munk's moment) faster than the fin turns it back. How fast a drift grows is the larger root of the linear equations of sway and
// yaw.
TEST(Hydrodynamics, the_moment_of_added_mass_turns_a_slender_hull_off_its_course_as_the_linear_equations_say) {
  constexpr double m = 148, inertia = 42, speed = 2, fin = 0.5 * 1000 * speed * 0.0244 * 4.13, arm = 1.05;
  constexpr double x_added = 4.876, y_added = 126.32, r_added = 33.46;
  const auto growth_of = [&](const std::string& more) {
    PhysicsFixture f(world_of_text(
        no_gravity +
        "<model name='auv'><link name='hull'><inertial><mass>148</mass><inertia><ixx>3</ixx><iyy>42</iyy><izz>42</izz></inertia>"
        "</inertial></link><plugin filename='gz-sim-lift-drag-system' name='fin'><link_name>hull</link_name><air_density>1000"
        "</air_density><cla>4.13</cla><cda>0</cda><alpha_stall>0.17</alpha_stall><area>0.0244</area><upward>0 1 0</upward>"
        "<cp>-1.05 0 0</cp></plugin>" +
        hydrodynamics("<xDotU>-4.876</xDotU><yDotV>-126.32</yDotV><zDotW>-126.32</zDotW><mDotQ>-33.46</mDotQ><nDotR>-33.46</nDotR>" +
                      more) +
        "</model>"));
    EXPECT_TRUE(f.physics.set_model_twist(0, {{speed, 1e-5, 0}, {0, 0, 0}}));
    const auto drift = [&] {
      const Eigen::Vector3d v = f.physics.model_pose(0).linear().transpose() * f.physics.link_twist(f.link("auv")).linear;
      return std::abs(v.y());
    };
    f.run(8);
    const double before = drift();
    f.run(8);
    return std::log(drift() / before) / 8;
  };
  Eigen::Matrix2d mass, moved;
  mass << m + y_added, 0, 0, inertia + r_added;
  moved << -fin, fin * arm - (m + x_added) * speed, fin * arm - (y_added - x_added) * speed, -fin * arm * arm;
  const Eigen::Matrix2d a = mass.inverse() * moved;
  const double expected = a.trace() / 2 + std::sqrt(a.trace() * a.trace() / 4 - a.determinant());
  EXPECT_NEAR(expected, 0.355, 0.01);
  EXPECT_NEAR(growth_of(""), expected, 0.01 * expected);
  // Without that moment the fin keeps the hull on its course.
  EXPECT_LT(growth_of("<disable_coriolis>true</disable_coriolis>"), -0.1);
}

TEST(Hydrodynamics, damping_that_is_too_strong_for_the_step_stops_the_body) {
  PhysicsFixture f(world_of_text(no_gravity + body("sub", 0, 1, {1, 1, 1}, hydrodynamics("<xU>-1e6</xU><nR>-1e6</nR>"))));
  ASSERT_TRUE(f.physics.set_model_twist(0, {{1, 0, 0}, {0, 0, 1}}));
  f.run(0.1);
  EXPECT_LT(f.physics.link_twist(f.link("sub")).linear.norm(), 1e-3);
  EXPECT_TRUE(f.physics.take_complaints().empty());
}

TEST(Hydrodynamics, a_plugin_that_means_no_link_is_left_out_with_a_line) {
  PhysicsFixture f(world_of_text(
      body("sub", 0, 1, {1, 1, 1}, "<plugin filename='gz-sim-hydrodynamics-system' name='h'><link_name>keel</link_name></plugin>")));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_THAT(f.dropped[0], testing::HasSubstr("model \"sub\" has no link \"keel\"; the plugin is left out"));
  PhysicsFixture bad(world_of_text(body("sub", 0, 1, {1, 1, 1}, hydrodynamics("<xU>much</xU>"))));
  ASSERT_EQ(bad.dropped.size(), 1U);
  EXPECT_THAT(bad.dropped[0], testing::HasSubstr("<xU> must be a number within 1e9, got \"much\""));
}

TEST(Hydrodynamics, positive_numbers_of_older_files_slow_down_too) {
  PhysicsFixture f(
      world_of_text(no_gravity + body("sub", 0, 50, {1, 1, 1}, hydrodynamics("<xU>20</xU><xUabsU>30</xUabsU><xDotU>10</xDotU>"))));
  ASSERT_EQ(f.notes.size(), 1U);
  EXPECT_THAT(f.notes[0], testing::HasSubstr("positive damping or added mass would drive the link"));
  for (int i = 0; i < 20000; ++i) {
    ASSERT_TRUE(f.physics.add_wrench(f.link("sub"), {50, 0, 0}, {0, 0, 0}));
    f.physics.step();
  }
  EXPECT_NEAR(f.physics.link_twist(f.link("sub")).linear.x(), 1, 1e-6);
}

TEST(Hydrodynamics, added_mass_that_is_negative_in_some_direction_is_left_out_with_a_line) {
  PhysicsFixture f(
      world_of_text(no_gravity + body("sub", 0, 50, {1, 1, 1},
                                      hydrodynamics("<xDotU>-10</xDotU><yDotV>-10</yDotV><xDotV>-30</xDotV><yDotU>-30</yDotU>"))));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_THAT(f.dropped[0], testing::HasSubstr("added mass of link \"hull\": it must be positive in every direction"));
  ASSERT_TRUE(f.physics.set_model_twist(0, {{1, -1, 0}, {0, 0, 0}}));
  f.run(1);
  EXPECT_NEAR(f.physics.link_twist(f.link("sub")).linear.norm(), std::sqrt(2), 1e-9);
}

TEST(Hydrodynamics, is_the_same_after_a_reset) {
  const std::string sub = body("sub", -2, 100, {2, 0.5, 0.5}, hydrodynamics("<xDotU>-20</xDotU><yDotV>-120</yDotV><zW>-50</zW>"));
  PhysicsFixture f(world_of_text(pond + sub));
  f.run(2);
  const auto hash = f.hash();
  f.physics.reset();
  f.run(2);
  EXPECT_EQ(f.hash(), hash);
}

// A wing of 1 m^2 in an air stream of 10 m/s at 0.1 rad: lift and drag by hand.
TEST(LiftDrag, is_that_of_the_angle_of_attack) {
  const auto force_at = [](double pitch, const std::string& more) {
    PhysicsFixture f(world_of_text(
        no_gravity + fmt::format("<model name='plane'><pose>0 0 0 0 {} 0</pose><link name='hull'><inertial><mass>1e6</mass>"
                                 "</inertial></link><plugin filename='gz-sim-lift-drag-system' name='wing'><link_name>hull</link_name>"
                                 "<area>1</area><air_density>1.2</air_density><cla>5</cla><cda>0.5</cda><alpha_stall>0.3</alpha_stall>"
                                 "<cla_stall>-2</cla_stall><cda_stall>1</cda_stall>{}</plugin></model>",
                                 pitch, more)));
    (void)f.physics.set_model_twist(0, {{10, 0, 0}, {0, 0, 0}});
    f.physics.step();
    const Twist after = f.physics.link_twist(f.link("plane"));
    return Eigen::Vector3d((after.linear - Eigen::Vector3d(10, 0, 0)) * 1e6 / 0.001);
  };
  // Nose up is a negative pitch in SDFormat.
  EXPECT_NEAR(force_at(-0.1, "").z(), 60 * 5 * 0.1, 0.01);
  EXPECT_NEAR(force_at(-0.1, "").x(), -60 * 0.5 * 0.1, 0.01);
  EXPECT_NEAR(force_at(0.1, "").z(), -60 * 5 * 0.1, 0.01);
  EXPECT_NEAR(force_at(0.1, "").x(), -60 * 0.5 * 0.1, 0.01);
  EXPECT_NEAR(force_at(-0.5, "").z(), 60 * (5 * 0.3 - 2 * 0.2), 0.01) << "it stalls";
  EXPECT_NEAR(force_at(0, "<a0>0.05</a0>").z(), 60 * 5 * 0.05, 0.01);
}

}  // namespace
}  // namespace sim

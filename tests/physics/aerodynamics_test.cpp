// Aeroplanes by their stability derivatives and hulls of airships: forces by hand, and how they move.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <numbers>

#include "physics/aerodynamics.h"
#include "support/physics_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;
using A = AirframeDef;
constexpr double radian = std::numbers::pi / 180;

// A wing of 2 m^2 and a span of 4 m in air of 1.2 kg/m^3.
AirframeDef glider() {
  AirframeDef def;
  def.area = 2, def.aspect_ratio = 8, def.efficiency = 0.9, def.density = 1.2, def.stall = 1;
  def.span = 4, def.chord = 0.5;
  def.coefficients(A::lift, A::at_zero) = 0.2, def.coefficients(A::lift, A::by_alpha) = 5;
  def.coefficients(A::drag, A::at_zero) = 0.03;
  def.coefficients(A::pitch, A::at_zero) = 0.05, def.coefficients(A::pitch, A::by_alpha) = -0.6;
  def.coefficients(A::pitch, A::by_pitch) = -12, def.coefficients(A::pitch, A::by_beta) = 0.01;
  def.coefficients(A::side, A::by_beta) = -0.3, def.coefficients(A::yaw, A::by_beta) = 0.1;
  def.coefficients(A::roll, A::by_roll) = -0.5, def.coefficients(A::roll, A::by_beta) = -0.04;
  def.pitch_stalled = -0.1;
  return def;
}
constexpr double pressure = 0.5 * 1.2 * 400 * 2;  // times the area [N]
double induced(double lift) { return lift * lift / (std::numbers::pi * 8 * 0.9); }

TEST(Airframe, lifts_and_drags_by_its_angle_of_attack) {
  const AirframeDef def = glider();
  const AirForce level = force_on(def, {20, 0, 0}, {0, 0, 0}, {});
  EXPECT_NEAR(level.force.z(), pressure * 0.2, 0.01);
  EXPECT_NEAR(level.force.x(), -pressure * (0.03 + induced(0.2)), 0.02);
  EXPECT_NEAR(level.torque.y(), -pressure * 0.5 * 0.05, 0.01) << "nose up is negative about the left";
  // The nose 0.1 rad above the way: the air comes from below.
  const double alpha = 0.1, lift = 0.2 + 5 * alpha, drag = 0.03 + induced(lift);
  const AirForce climbing = force_on(def, {20 * std::cos(alpha), 0, -20 * std::sin(alpha)}, {0, 0, 0}, {});
  EXPECT_NEAR(climbing.force.z(), pressure * (lift * std::cos(alpha) + drag * std::sin(alpha)), 0.02 * pressure * lift);
  EXPECT_NEAR(climbing.force.x(), pressure * (lift * std::sin(alpha) - drag * std::cos(alpha)), 0.02 * pressure * lift);
  EXPECT_NEAR(climbing.torque.y(), -pressure * 0.5 * (0.05 - 0.6 * alpha), 0.01);
}

TEST(Airframe, beyond_the_stall_is_a_flat_plate) {
  AirframeDef def = glider();
  def.stall = 0.3;
  const AirForce falling = force_on(def, {0, 0, -20}, {0, 0, 0}, {});
  const double plate = 2 / (1 + std::exp(-0.224 - 0.115 * 8));
  EXPECT_NEAR(falling.force.z(), pressure * plate, 0.01 * pressure);
  EXPECT_NEAR(falling.force.x(), 0, 0.01 * pressure);
  const double beyond = std::numbers::pi / 2 - 0.3;
  EXPECT_NEAR(falling.torque.y(), -pressure * 0.5 * (0.05 - 0.6 * 0.3 - 0.1 * beyond), 0.01);
}

TEST(Airframe, feels_its_sideslip_its_rates_and_its_control_surfaces) {
  AirframeDef def = glider();
  const double beta = 0.1;  // it moves to the right, which is -y
  const AirForce slipping = force_on(def, {20, -20 * std::tan(beta), 0}, {0, 0, 0}, {});
  EXPECT_NEAR(slipping.force.y(), pressure * 0.3 * beta, 0.01) << "pushed back to the left";
  EXPECT_NEAR(slipping.torque.z(), -pressure * 4 * 0.1 * beta, 0.02) << "the nose turns to the right, into the wind";
  EXPECT_NEAR(slipping.torque.x(), -pressure * 4 * 0.04 * beta, 0.02);
  EXPECT_NEAR(slipping.torque.y(), -pressure * 0.5 * (0.05 + 0.01 * beta), 0.01);
  const AirForce rolling = force_on(def, {20, 0, 0}, {0.2, 0, 0}, {});
  EXPECT_NEAR(rolling.torque.x(), -pressure * 4 * 0.5 * 0.2 * 4 / 40, 0.01);
  const AirForce pitching = force_on(def, {20, 0, 0}, {0, -0.2, 0}, {});  // nose up
  EXPECT_NEAR(pitching.torque.y() - force_on(def, {20, 0, 0}, {0, 0, 0}, {}).torque.y(), pressure * 0.5 * 12 * 0.2 * 0.5 / 40, 0.01);
  A::Surface elevator;
  elevator.effect[A::pitch] = 0.01, elevator.effect[A::lift] = 0.02;
  def.surfaces = {elevator};
  const double angle[] = {5 * radian};
  const AirForce steered = force_on(def, {20, 0, 0}, {0, 0, 0}, angle);
  EXPECT_NEAR(steered.torque.y(), -pressure * 0.5 * (0.05 + 0.01 * 5), 0.01);
  EXPECT_NEAR(steered.force.z(), pressure * (0.2 + 0.02 * 5), 0.01);
  EXPECT_TRUE(force_on(def, {0, 0, 0}, {1, 1, 1}, angle).force.isZero());
}

std::string plane(const std::string& numbers) {
  return "<model name='plane'><link name='hull'><inertial><mass>2</mass><inertia><ixx>0.2</ixx><iyy>0.15</iyy><izz>0.15</izz></inertia>"
         "</inertial></link><link "
         "name='flap'><inertial><mass>0.01</mass><inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia></inertial></link><joint "
         "name='servo' type='revolute'>"
         "<parent>hull</parent><child>flap</child><axis><xyz>0 1 0</xyz><limit><lower>-0.5</lower><upper>0.5</upper></limit></axis></joint>"
         "<plugin filename='gz-sim-advanced-lift-drag-system' name='gz::sim::systems::AdvancedLiftDrag'><link_name>hull</link_name>" +
         numbers + "</plugin></model>";
}

const std::string of_a_plane =
    "<CL0>0.15</CL0><AR>6.5</AR><eff>0.97</eff><CLa>5</CLa><CD0>0.03</CD0><Cema>-0.46</Cema><CYb>-0.26</CYb><Cellb>-0.04</Cellb>"
    "<Cenb>0.1</Cenb><Cellp>-0.49</Cellp><CLq>8</CLq><Cemq>-12</Cemq><Cenr>-0.09</Cenr><alpha_stall>0.34</alpha_stall><area>0.34</area>"
    "<mac>0.22</mac><air_density>1.2041</air_density>";

// It comes to the glide in which lift carries it: sink over speed is drag over lift.
TEST(Airframe, glides_as_its_lift_and_drag_say) {
  PhysicsFixture f(world_of_text("<gravity>0 0 -9.81</gravity>" + plane(of_a_plane)));
  EXPECT_THAT(f.notes, testing::IsEmpty());
  ASSERT_TRUE(f.physics.set_model_twist(0, {{15, 0, 0}, {0, 0, 0}}));
  f.run(60);
  const Eigen::Vector3d from = f.position("plane");
  f.run(60);
  const Eigen::Vector3d way = f.position("plane") - from;
  const double lift = 0.15;  // without a moment at zero it trims where the pitching moment is 0: at alpha 0
  EXPECT_NEAR(-way.z() / way.x(), (0.03 + lift * lift / (std::numbers::pi * 6.5 * 0.97)) / lift, 0.01);
  const double speed = way.norm() / 60;
  EXPECT_NEAR(0.5 * 1.2041 * speed * speed * 0.34 * lift, 2.01 * 9.81, 0.5);
}

TEST(Airframe, that_is_wrong_is_left_out_with_one_line) {
  for (const auto& [numbers, expected] :
       {std::pair{"<CLa>5</CLa>", "expected a <AR>; the plugin is left out"},
        {"<AR>-6</AR><eff>1</eff>", "<AR> must be a positive number, got \"-6\"; the plugin is left out"},
        {"<AR>6</AR><eff>much</eff>", "<eff> must be a number within 1e9, got \"much\"; the plugin is left out"},
        {"<AR>6</AR><eff>1</eff><CLa>steep</CLa>", "<CLa> must be a number within 1e9, got \"steep\"; the plugin is left out"},
        {"<AR>6</AR><eff>1</eff><upward>1 0 0</upward>", "<forward> and <upward> must be two directions; the plugin is left out"},
        {"<AR>6</AR><eff>1</eff><control_surface><name>x</name></control_surface>", "model \"plane\" has no joint \"x\"; the plugin"},
        {"<AR>6</AR><eff>1</eff><num_ctrl_surfaces>2</num_ctrl_surfaces>", "at most the number of <control_surface>, which is 0, got 2"}}) {
    const WorldDef world = world_of_text(plane(numbers));
    std::vector<std::string> left_out;
    EXPECT_TRUE(airframes_of(world.models[0], left_out).empty());
    ASSERT_EQ(left_out.size(), 1U) << numbers;
    EXPECT_THAT(left_out[0], testing::HasSubstr(expected));
  }
}

AirshipDef hull() {
  AirshipDef def;
  def.density = 1.2, def.force_inviscid = 3, def.force_viscous = 2, def.moment_inviscid = 8, def.moment_viscous = -1.5;
  def.axial_drag = 0.3, def.separation = 1;
  return def;
}

TEST(Airship, hull_feels_the_flow_at_its_separation_and_along_its_axis) {
  const AirshipDef def = hull();
  for (const double speed : {4.0, -4.0}) {
    const AirForce ahead = force_on(def, {speed, 0, 0}, {0, 0, 0});
    EXPECT_NEAR(ahead.force.x(), -std::copysign(0.5 * 1.2 * 16 * 0.3, speed), 1e-9);
    EXPECT_NEAR(ahead.torque.norm(), 0, 1e-9);
  }
  const AirForce aside = force_on(def, {0, 4, 0}, {0, 0, 0});
  EXPECT_NEAR(aside.force.y(), -0.5 * 1.2 * 16 * 2, 1e-9);
  EXPECT_NEAR(aside.torque.z(), 0.5 * 1.2 * 16 * 1.5, 1e-9);
  const double angle = std::atan2(1, 4), q = 0.5 * 1.2 * 17, viscous = std::sin(angle) * std::sin(angle), twice = std::sin(2 * angle);
  const AirForce slipping = force_on(def, {4, 0, 1}, {0, 0, 0});
  EXPECT_NEAR(slipping.force.z(), -q * (-3 * twice + 2 * viscous), 1e-9);
  EXPECT_NEAR(slipping.torque.y(), q * (-8 * twice - 1.5 * viscous), 1e-9);
  // A turn alone moves the air at the separation, 1 m behind: it goes to the right there.
  EXPECT_NEAR(force_on(def, {0, 0, 0}, {0, 0, 2}).force.y(), 0.5 * 1.2 * 4 * 2, 1e-9);
}

// 10 N push the hull, with its added mass of 5 kg: at first like 15 kg, at last as fast as drag allows.
TEST(Airship, accelerates_with_its_added_mass_up_to_the_speed_of_its_drag) {
  const std::string plugin =
      "<plugin filename='gz-sim-lighter_than_air_dynamics-system' name='gz::sim::systems::LighterThanAirDynamics'><link_name>hull"
      "</link_name><air_density>1.2</air_density><force_inviscid_coeff>3</force_inviscid_coeff><force_viscous_coeff>2</force_viscous_coeff>"
      "<moment_inviscid_coeff>8</moment_inviscid_coeff><moment_viscous_coeff>-1.5</moment_viscous_coeff><eps_v>1</eps_v>"
      "<axial_drag_coeff>0.3</axial_drag_coeff></plugin>";
  PhysicsFixture f(world_of_text(
      "<gravity>0 0 0</gravity><model name='ship'><link name='hull'><inertial><mass>10</mass><inertia><ixx>2</ixx><iyy>9</iyy><izz>9</izz>"
      "</inertia><fluid_added_mass><xx>5</xx><yy>9</yy><zz>9</zz></fluid_added_mass></inertial></link>" +
          plugin + "</model>",
      "1.9"));
  const auto push = [&] { ASSERT_TRUE(f.physics.add_wrench(f.link("ship"), {10, 0, 0}, {0, 0, 0})); };
  for (int i = 0; i < 300; ++i) push(), f.physics.step();
  EXPECT_NEAR(f.physics.link_twist(f.link("ship")).linear.x(), 0.3 * 10 / 15, 0.005);
  for (int i = 0; i < 60000; ++i) push(), f.physics.step();
  EXPECT_NEAR(f.physics.link_twist(f.link("ship")).linear.x(), std::sqrt(10 / (0.5 * 1.2 * 0.3)), 0.02);
}

// Two hulls of VRX, each of two slices, with a radius of 0.2 m and 4 m long: they carry the boat where they are half as deep.
TEST(FloatingHull, carries_a_boat_at_the_depth_of_its_weight) {
  FloatingHullDef hull;
  hull.radius = 0.2, hull.length = 4, hull.points = {{1, 0, 0}, {-1, 0, 0}};
  EXPECT_NEAR(lift_on(hull, 0.2, 9.81), std::numbers::pi * 0.2 * 0.2 / 2 * 4 / 2 * 1000 * 9.81, 1e-6) << "half a cylinder";
  EXPECT_EQ(lift_on(hull, 5, 9.81), lift_on(hull, 0.2, 9.81));
  EXPECT_EQ(lift_on(hull, -0.1, 9.81), 0);
  const double mass = 4 * lift_on(hull, 0.1, 9.81) / 9.81;
  const std::string surface =
      "<plugin filename='libSurface.so' name='vrx::Surface'><link_name>base</link_name><hull_length>4</hull_length><hull_radius>0.2"
      "</hull_radius><fluid_level>0</fluid_level><points><point>1 SIDE 0</point><point>-1 SIDE 0</point></points></plugin>";
  const auto at_side = [&](std::string text, const std::string& side) {
    for (auto at = text.find("SIDE"); at != std::string::npos; at = text.find("SIDE")) text.replace(at, 4, side);
    return text;
  };
  PhysicsFixture f(world_of_text(
      "<gravity>0 0 -9.81</gravity><model name='boat'><link name='base'><inertial><mass>" + std::to_string(mass) +
      "</mass><inertia><ixx>120</ixx><iyy>390</iyy><izz>440</izz></inertia></inertial></link>" + at_side(surface, "1") +
      at_side(surface, "-1") +
      "<plugin filename='libSimpleHydrodynamics.so' name='vrx::SimpleHydrodynamics'><link_name>base</link_name><zW>900</zW><kP>900</kP>"
      "<mQ>900</mQ></plugin></model>"));
  EXPECT_TRUE(f.notes.empty()) << "VRX's numbers are positive";
  f.run(30);
  EXPECT_NEAR(f.position("boat").z(), -0.1, 0.002);
}

// Its file needs no number, and its added mass turns no boat that drifts: VRX has no Coriolis forces.
TEST(SimpleHydrodynamics, has_the_numbers_of_vrx_where_the_file_has_none) {
  const auto boat = [](const std::string& numbers) {
    return world_of_text(
        "<gravity>0 0 0</gravity><model name='boat'><link name='base'><inertial><mass>95</mass></inertial></link>"
        "<plugin filename='libSimpleHydrodynamics.so' name='vrx::SimpleHydrodynamics'><link_name>base</link_name>" +
        numbers + "</plugin></model>");
  };
  PhysicsFixture f(boat("<xU>0</xU>"));
  ASSERT_TRUE(f.physics.set_model_twist(0, {{1, 0.5, 0}, {0, 0, 0}}));
  f.run(5);
  const Twist after = f.physics.link_twist(f.link("boat"));
  EXPECT_NEAR(after.linear.x(), 1, 1e-3);
  EXPECT_NEAR(after.linear.y(), 0.5 * std::exp(-20 * 5 / (95 + 5.0)), 2e-3);
  EXPECT_NEAR(after.angular.norm(), 0, 1e-9);
  EXPECT_TRUE(f.notes.empty());
  PhysicsFixture driven(boat("<xU>-10</xU>"));
  EXPECT_THAT(driven.notes, testing::ElementsAre(testing::HasSubstr("negative damping or added mass would drive the link")));
}

TEST(FloatingHull, that_is_wrong_is_left_out_with_one_line) {
  for (const auto& [numbers, expected] :
       {std::pair{"<hull_length>4</hull_length>", "expected a <hull_radius>; the plugin is left out"},
        {"<hull_length>4</hull_length><hull_radius>-1</hull_radius>", "<hull_radius> must be a positive number, got \"-1\""},
        {"<hull_length>4</hull_length><hull_radius>wide</hull_radius>", "<hull_radius> must be a number within 1e9, got \"wide\""},
        {"<hull_length>4</hull_length><hull_radius>0.2</hull_radius>", "expected <points> with a <point>"}}) {
    auto loaded = load_world_text(std::string("<sdf version='1.9'><world name='w'><model name='m'><link name='base'/><plugin "
                                              "filename='libSurface.so' name='vrx::Surface'><link_name>base</link_name>") +
                                      numbers + "</plugin></model></world></sdf>",
                                  {}, "w.sdf", ModelPath{});
    ASSERT_TRUE(loaded);
    std::vector<std::string> lines, notes;
    for (const Finding& finding : loaded->findings) lines.push_back(finding.message);
    EXPECT_TRUE(floating_hulls_of(loaded->world.models[0], lines, notes).empty());
    ASSERT_EQ(lines.size(), 1U) << numbers;
    EXPECT_THAT(lines[0], testing::HasSubstr(expected));
  }
}

TEST(Airship, without_one_of_its_coefficients_is_left_out_with_one_line) {
  const WorldDef world = world_of_text(
      "<model name='m'><link name='hull'/><plugin filename='gz-sim-lighter_than_air_dynamics-system' name='p'><link_name>hull</link_name>"
      "<force_inviscid_coeff>3</force_inviscid_coeff></plugin></model>");
  std::vector<std::string> left_out;
  EXPECT_TRUE(airships_of(world.models[0], left_out).empty());
  ASSERT_EQ(left_out.size(), 1U);
  EXPECT_THAT(left_out[0], testing::HasSubstr("plugin \"p\": expected a <force_viscous_coeff>; the plugin is left out"));
}

}  // namespace
}  // namespace sim

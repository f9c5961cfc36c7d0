// Multicopters, thrusters and what commands them, against formulas: docs/worlds.md says what they do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/joint_client.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "support/vehicles.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

void command(shm::Iface& iface, const std::array<double, 6>& velocity) { ASSERT_TRUE(iface.command(shm::CommandKind::velocity, velocity)); }

shm::Position3dSample sample(shm::Iface& iface) {
  EXPECT_TRUE(iface.read());
  return iface.sample<shm::Position3dSample>();
}

double height(SimulationFixture& f, const std::string& model) {
  return f.simulation->physics().model_pose(*f.simulation->physics().find(model)).translation().z();
}

// --- rotors

TEST(Rotor, follows_a_step_with_its_time_constant_whatever_the_step) {
  for (const double step : {0.0005, 0.001, 0.0025}) {
    WorldDef world = world_of_text(weightless + quadcopter("x3", "0 0 5 0 0 0", false));
    world.physics.step = step;
    SimulationFixture f(std::move(world));
    Joints joints(f, "x3");
    joints.command(0, RTMSIM_JOINT_VELOCITY, 500);
    f.run(0.0125);  // to the end of the step in which this is
    const double seconds = std::chrono::duration<double>(f.simulation->time()).count();
    EXPECT_NEAR(joints.state(0).velocity / 500, 1 - std::exp(-seconds / 0.0125), 1e-3) << step;
    if (step != 0.001) {
      EXPECT_NEAR(joints.state(0).velocity / 500, 0.632, 1e-3) << step;
    }
    f.run(0.2);
    EXPECT_NEAR(joints.state(0).velocity, 500, 0.1);
    joints.command(0, RTMSIM_JOINT_FREE, 0);
    f.run(0.025);
    EXPECT_NEAR(joints.state(0).velocity / 500, std::exp(-1), 0.002) << step;
  }
}

TEST(Rotor, pushes_with_the_square_of_its_speed_and_turns_its_body_the_other_way) {
  SimulationFixture f(world_of_text(weightless + quadcopter("x3", "0 0 5 0 0 0", false)));
  Joints joints(f, "x3");
  EXPECT_EQ(joints.info(0).max_velocity, 800);
  EXPECT_NEAR(joints.info(0).max_effort, 8.54858e-6 * 640000, 1e-9);
  EXPECT_THAT(joints.info(0).gains_from, testing::StartsWith("propeller of w.sdf:"));
  for (std::size_t i = 0; i < 4; ++i) joints.command(i, RTMSIM_JOINT_VELOCITY, 660.4);
  f.run(0.3);
  EXPECT_NEAR(joints.state(0).effort, 3.728, 0.002);
  const double before = f.simulation->physics().link_twist({0, 0}).linear.z();
  f.run(0.1);
  EXPECT_NEAR((f.simulation->physics().link_twist({0, 0}).linear.z() - before) / 0.1, 9.81, 0.01);
  joints.command(0, RTMSIM_JOINT_FREE, 0), joints.command(1, RTMSIM_JOINT_FREE, 0);
  f.run(0.2);
  EXPECT_GT(f.simulation->physics().link_twist({0, 0}).angular.z(), 0.1) << "those that turn clockwise turn it to the left";
}

// Its drag and its rolling moment go with its speed and the flow across its axis.
TEST(Rotor, drags_and_rolls_its_body_in_the_flow_across_its_axis) {
  SimulationFixture f(world_of_text(weightless + quadcopter("x3", "0 0 5 0 0 0", false)));
  Joints joints(f, "x3");
  for (std::size_t i = 0; i < 4; ++i) joints.command(i, RTMSIM_JOINT_VELOCITY, 500);
  ASSERT_TRUE(f.simulation->physics().set_model_twist(0, {{1, 0, 0}, {0, 0, 0}}));
  f.run(0.1);
  const auto before = f.simulation->physics().link_twist({0, 0});
  f.run(0.2);
  const auto after = f.simulation->physics().link_twist({0, 0});
  const double drag = 4 * 500 * 8.06428e-5 / 1.52;
  // The body begins to tilt, and its thrust with it.
  EXPECT_NEAR(std::log(before.linear.x() / after.linear.x()) / 0.2, drag, 0.08 * drag);
  const double inertia = 0.0347563 + 0.005 * 2 * (0.22 * 0.22 + 0.2 * 0.2), rolling = -4 * 500 * 1e-6 / inertia;
  EXPECT_NEAR((after.angular.x() - before.angular.x()) / 0.2, rolling, -0.05 * rolling);
}

// --- multicopters

TEST(Multicopter, falls_until_a_client_commands_it_and_then_hovers_at_660_radians_a_second) {
  SimulationFixture f(world_of_text(air + flat_ground + quadcopter("x3", "0 0 50 0 0 0")));
  auto pilot = f.open(IfaceType::position3d, "x3::position3d");
  f.run(1);
  EXPECT_NEAR(height(f, "x3"), 50 - 9.81 / 2, 0.02);
  command(pilot, {0, 0, 0, 0, 0, 0});
  f.run(8);
  Joints joints(f, "x3");
  f.run(0.1);
  const double hover = height(f, "x3");
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(joints.state(i).velocity, 660.4, 15) << i;
  double mean = 0;
  for (std::size_t i = 0; i < 4; ++i) mean += joints.state(i).velocity * joints.state(i).velocity / 4;
  EXPECT_NEAR(std::sqrt(mean), 660.4, 0.5);
  f.run(5);
  EXPECT_NEAR(height(f, "x3"), hover, 0.02);
  EXPECT_EQ(sample(pilot).commanded, 1U);
}

TEST(Multicopter, flies_as_it_is_told_and_hovers_when_its_pilot_goes) {
  SimulationFixture f(world_of_text(air + flat_ground + quadcopter("x3", "0 0 5 0 0 0")));
  auto watch = f.open(IfaceType::position3d, "x3::position3d");
  {
    auto pilot = f.open(IfaceType::position3d, "x3::position3d");
    command(pilot, {1, 0, 0.3, 0, 0, 0});
    f.run(10);
    const auto now = sample(watch);
    // The controller is proportional, and the rotors drag: 4 w c for each m/s.
    EXPECT_NEAR(now.velocity[0], 2.7 / (2.7 + 4 * 660.4 * 8.06428e-5), 0.02);
    EXPECT_NEAR(now.velocity[1], 0, 0.01);
    EXPECT_NEAR(now.velocity[2], 0.3, 0.05);
    EXPECT_EQ(now.stalled, 0U);
    command(pilot, {0, 0, 0, 0, 0, 0.4});
    f.run(10);
    EXPECT_NEAR(sample(watch).velocity[5], 0.4, 0.03);
  }
  f.run(10);
  EXPECT_LT(std::hypot(sample(watch).velocity[0], sample(watch).velocity[1], sample(watch).velocity[2]), 0.02);
}

TEST(Multicopter, without_a_controller_in_its_file_gets_one_from_its_mass) {
  SimulationFixture f(world_of_text(air + flat_ground + quadcopter("x3", "0 0 5 0 0 0", false)));
  auto pilot = f.open(IfaceType::position3d, "x3::position3d");
  command(pilot, {1, 0, 0, 0, 0, 0});
  f.run(10);
  EXPECT_NEAR(sample(pilot).velocity[0], 1, 0.1);
  command(pilot, {0, 0, 0, 0, 0, 0.5});
  f.run(10);
  EXPECT_NEAR(sample(pilot).velocity[5], 0.5, 0.05);
}

TEST(Multicopter, flies_to_a_goal_and_falls_with_its_motors_off) {
  SimulationFixture f(world_of_text(air + flat_ground + quadcopter("x3", "1 0 5 0 0 0")));
  auto pilot = f.open(IfaceType::position3d, "x3::position3d");
  const std::array<double, 6> goal{2, -1, 3, 0, 0, 1};  // in odometry, which began at its start
  ASSERT_TRUE(pilot.command(shm::CommandKind::pose, goal));
  f.run(20);
  const auto there = sample(pilot);
  EXPECT_NEAR(there.odometry.x, 2, 0.05);
  EXPECT_NEAR(there.odometry.y, -1, 0.05);
  EXPECT_NEAR(there.odometry.z, 3, 0.05);
  EXPECT_NEAR(there.true_pose.x, 3, 0.05);
  EXPECT_NEAR(2 * std::atan2(there.true_pose.qz, there.true_pose.qw), 1, 0.02);
  f.simulation->device("x3::position3d")->set_motors(false);
  f.run(3);
  EXPECT_LT(height(f, "x3"), 0.2);
  f.simulation->device("x3::position3d")->set_motors(true);
  command(pilot, {0, 0, 0.5, 0, 0, 0});
  f.run(5);
  EXPECT_GT(height(f, "x3"), 0.5);
}

TEST(Multicopter, a_weak_drive_is_slower_and_a_halted_one_goes_on) {
  SimulationFixture f(world_of_text(air + flat_ground + quadcopter("x3", "0 0 5 0 0 0")));
  auto pilot = f.open(IfaceType::position3d, "x3::position3d");
  command(pilot, {1, 0, 0, 0, 0, 0});
  const auto fault = [&](shm::FaultKind kind, const std::string& name = "x3::position3d") {
    ASSERT_TRUE(f.simulation->add_fault({name, kind, 0.5, f.simulation->time()}));
  };
  fault(shm::FaultKind::weak);
  f.run(8);
  EXPECT_NEAR(sample(pilot).velocity[0], 0.5, 0.05);
  EXPECT_EQ(f.simulation->end_faults({}, std::nullopt), 1U);
  f.run(8);
  fault(shm::FaultKind::halted);
  command(pilot, {0, 0, 0, 0, 0, 0});
  f.run(8);
  EXPECT_NEAR(sample(pilot).velocity[0], 1, 0.1);
  f.simulation->end_faults({}, std::nullopt);
  f.run(8);
  EXPECT_NEAR(sample(pilot).velocity[0], 0, 0.05);
  // A rotor that is halted keeps its speed while the vehicle asks for others.
  fault(shm::FaultKind::halted, "x3::joints::x3_joint_0");
  auto joints = f.open(IfaceType::joints, "x3::joints");
  const auto speed = [&](std::size_t joint) {
    EXPECT_TRUE(joints.read());
    return std::abs(joints.elements<shm::JointState>()[joint].velocity);
  };
  f.run(0.1);
  const double kept = speed(0);
  command(pilot, {0, 0, 3, 0, 0, 0});
  f.run(0.2);
  EXPECT_NEAR(speed(0), kept, 0.5);
  EXPECT_GT(speed(1), kept + 5);
  f.simulation->end_faults({}, std::nullopt);
  command(pilot, {0, 0, 0, 0, 0, 0});
  f.run(8);
  // A rotor that has half of its thrust left cannot carry its corner.
  fault(shm::FaultKind::weak, "x3::joints::x3_joint_0");
  f.run(5);
  EXPECT_LT(height(f, "x3"), 2);
}

TEST(Multicopter, is_the_same_after_a_reset_and_with_more_threads) {
  const auto fly = [](SimulationFixture& f) {
    auto pilot = f.open(IfaceType::position3d, "x3::position3d");
    command(pilot, {1, 0.5, 0.2, 0, 0, 0.3});
    f.run(2);
    return f.simulation->hash();
  };
  std::string all = air + flat_ground;
  for (int i = 0; i < 20; ++i) all += quadcopter("c" + std::to_string(i), std::to_string(2 * i) + " 5 1 0 0 0");
  all += quadcopter("x3", "0 0 5 0 0 0");
  SimulationFixture one(world_of_text(all));
  const auto hash = fly(one);
  std::vector<std::string> notes;
  ASSERT_TRUE(one.simulation->reset(notes));
  EXPECT_EQ(fly(one), hash);
  one.simulation.reset();
  one.server.reset();
  SimulationFixture many(world_of_text(all), 1, 3);
  EXPECT_EQ(fly(many), hash);
}

TEST(Multicopter, rotors_in_one_line_get_no_controller_and_a_line_says_so) {
  std::string text = "<model name='bar'><link name='base'/>";
  for (int i = 0; i < 4; ++i) text += rotor_link(i, 0.2 * i - 0.3, 0, "bar");
  for (int i = 0; i < 4; ++i) text += rotor_plugin(i, i % 2 == 0, "bar");
  SimulationFixture f(world_of_text(air + text + "</model>"));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_THAT(f.dropped[0], testing::HasSubstr("the rotors of model \"bar\" cannot turn it about all axes; it has no position3d"));
  EXPECT_NE(f.simulation->device("bar::joints"), nullptr);
}

TEST(Multicopter, a_rotor_that_its_controller_takes_for_one_of_the_other_hand_has_a_line) {
  std::string text = quadcopter("x3", "0 0 5 0 0 0");
  const std::string right =
      "x3_joint_0</jointName><forceConstant>8.54858e-06</forceConstant><momentConstant>0.016</momentConstant><direction>";
  const auto at = text.find(right);
  ASSERT_NE(at, std::string::npos);
  text.replace(at + right.size(), 1, "-1");
  SimulationFixture f(world_of_text(air + text));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_THAT(f.dropped[0], testing::HasSubstr("<direction> of joint \"x3_joint_0\" is -1, but its motor"));
  EXPECT_THAT(f.dropped[0], testing::HasSubstr("turns ccw, which is 1"));
}

TEST(Rotor, a_negative_command_has_one_line_with_its_range) {
  SimulationFixture f(world_of_text(weightless + quadcopter("x3", "0 0 5 0 0 0", false)));
  Joints joints(f, "x3");
  testing::internal::CaptureStderr();
  for (int i = 0; i < 3; ++i) {
    joints.command(0, RTMSIM_JOINT_VELOCITY, -5);
    f.run(0.01);
  }
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_EQ(joints.state(0).velocity, 0);
  const auto at = said.find("joint x3_joint_0: the command -5 is outside of 0 to 800, the nearest of which counts");
  ASSERT_NE(at, std::string::npos) << said;
  EXPECT_EQ(said.find("is outside of", at + 60), std::string::npos) << said;
}

// --- thrusters

const std::string uneven_torpedo =
    weightless + torpedo("auv", torpedo_thruster + "<max_thrust_cmd>30</max_thrust_cmd><min_thrust_cmd>-10</min_thrust_cmd>");

TEST(Thruster, an_uneven_range_is_named_as_it_is) {
  SimulationFixture f(world_of_text(uneven_torpedo));
  Joints joints(f, "auv");
  testing::internal::CaptureStderr();
  joints.command(0, RTMSIM_JOINT_EFFORT, -20);
  f.run(0.01);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), testing::HasSubstr("the command -20 is outside of -10 to 30"));
  EXPECT_NEAR(joints.state(0).effort, -10, 1e-9);
}

TEST(Thruster, of_the_other_hand_turns_backwards_to_push_forwards) {
  SimulationFixture f(
      world_of_text(weightless + torpedo("auv",
                                         "<thrust_coefficient>-0.004422</thrust_coefficient><propeller_diameter>0.2</propeller_diameter>"
                                         "<velocity_control>true</velocity_control>")));
  Joints joints(f, "auv");
  joints.command(0, RTMSIM_JOINT_EFFORT, 25.47);
  f.run(0.1);
  EXPECT_NEAR(joints.state(0).effort, 25.47, 1e-9);
  EXPECT_NEAR(joints.state(0).velocity, -60, 0.01);
}

TEST(Thruster, at_sixty_radians_a_second_drives_a_torpedo_at_two_metres_a_second) {
  SimulationFixture f(world_of_text(weightless + torpedo("auv", torpedo_thruster)));
  Joints joints(f, "auv");
  joints.command(0, RTMSIM_JOINT_VELOCITY, 60);
  f.run(1);
  EXPECT_NEAR(joints.state(0).velocity, 60, 0.01);
  EXPECT_NEAR(joints.state(0).effort, 25.47, 0.005);
  f.run(150);
  EXPECT_NEAR(f.simulation->physics().link_twist({0, 0}).linear.norm(), 2.022, 0.001);
}

TEST(Thruster, takes_a_thrust_as_effort_within_its_limits) {
  SimulationFixture f(world_of_text(uneven_torpedo));
  Joints joints(f, "auv");
  joints.command(0, RTMSIM_JOINT_EFFORT, 25.47);
  f.run(0.1);
  EXPECT_NEAR(joints.state(0).velocity, 60, 0.01);
  EXPECT_NEAR(joints.state(0).effort, 25.47, 1e-9);
  joints.command(0, RTMSIM_JOINT_EFFORT, 100);
  f.run(0.1);
  EXPECT_NEAR(joints.state(0).effort, 30, 1e-9);
  joints.command(0, RTMSIM_JOINT_VELOCITY, -1000);
  f.run(0.1);
  EXPECT_NEAR(joints.state(0).effort, -10, 1e-9);
  joints.command(0, RTMSIM_JOINT_BRAKE, 0);
  f.run(0.1);
  EXPECT_EQ(joints.state(0).effort, 0);
}

TEST(Thruster, with_a_controller_for_its_joint_pushes_at_once_and_never_swings) {
  SimulationFixture f(
      world_of_text(weightless + torpedo("auv",
                                         "<thrust_coefficient>0.004422</thrust_coefficient><propeller_diameter>0.2</propeller_diameter>"
                                         "<p_gain>100</p_gain>")));
  Joints joints(f, "auv");
  joints.command(0, RTMSIM_JOINT_EFFORT, 25.47);
  f.run(0.002);
  EXPECT_NEAR(joints.state(0).effort, 25.47, 1e-9);
  f.run(0.2);
  for (int i = 0; i < 10; ++i) {
    f.run(0.001);
    EXPECT_NEAR(joints.state(0).velocity, 60, 0.2);
  }
}

TEST(Thruster, a_coefficient_of_the_advance_ratio_falls_with_the_speed) {
  SimulationFixture f(
      world_of_text(weightless + torpedo("auv",
                                         "<propeller_diameter>0.2</propeller_diameter><alpha_1>0.005</alpha_1><alpha_2>-0.01</alpha_2>"
                                         "<velocity_control>true</velocity_control>")));
  Joints joints(f, "auv");
  joints.command(0, RTMSIM_JOINT_VELOCITY, 60);
  f.run(0.01);
  EXPECT_NEAR(joints.state(0).effort, 0.005 * 1.6 * 3600, 0.05);
  ASSERT_TRUE(f.simulation->physics().set_model_twist(0, {{1.5, 0, 0}, {0, 0, 0}}));
  f.run(0.001);
  EXPECT_NEAR(joints.state(0).effort, (0.005 - 0.01 * 0.8 * 1.5 / 12) * 1.6 * 3600, 0.05);
}

TEST(Thruster, of_a_joint_that_is_not_there_is_left_out_with_a_line) {
  SimulationFixture f(world_of_text(
      "<model name='m'><link name='l'/><plugin filename='gz-sim-thruster-system' name='t'><joint_name>x</joint_name></plugin></model>"));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_THAT(f.dropped[0], testing::HasSubstr("plugin \"t\": model \"m\" has no joint \"x\"; the plugin is left out"));
}

// --- boats

std::string boat() {
  std::string text =
      "<model name='boat'><pose>0 0 0.05 0 0 0</pose><link "
      "name='hull'><inertial><mass>500</mass><inertia><ixx>56.7</ixx><iyy>181.7</iyy><izz>208.3</izz>"
      "</inertia></inertial><collision name='c'><geometry><box><size>2 1 0.6</size></box></geometry></collision></link>";
  for (const char* side : {"left", "right"}) {
    text += fmt::format(
        "<link name='{0}'><pose>-1 {1} -0.1 0 0 "
        "0</pose><inertial><mass>0.5</mass><inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia></inertial>"
        "</link><joint name='{0}_shaft' type='revolute'><parent>hull</parent><child>{0}</child><axis><xyz>1 0 0</xyz></axis></joint>"
        "<plugin filename='gz-sim-thruster-system' "
        "name='gz::sim::systems::Thruster'><joint_name>{0}_shaft</joint_name><thrust_coefficient>0.01</thrust_coefficient>"
        "<propeller_diameter>0.2</propeller_diameter><velocity_control>true</velocity_control><max_thrust_cmd>200</"
        "max_thrust_cmd><min_thrust_cmd>-200</min_thrust_cmd>"
        "</plugin>",
        side, side == std::string("left") ? 0.4 : -0.4);
  }
  return text +
         "<plugin filename='gz-sim-hydrodynamics-system' "
         "name='gz::sim::systems::Hydrodynamics'><link_name>hull</link_name><xU>-50</xU><xUabsU>-70</xUabsU>"
         "<yV>-300</yV><yVabsV>-300</yVabsV><zW>-1500</zW><kP>-200</kP><mQ>-500</mQ><nR>-200</nR></plugin></model>";
}
const std::string pond =
    "<gravity>0 0 -9.81</gravity><plugin filename='gz-sim-buoyancy-system' name='gz::sim::systems::Buoyancy'><graded_buoyancy>"
    "<default_density>1000</default_density><density_change><above_depth>0</above_depth><density>1.2</density></density_change></"
    "graded_buoyancy></plugin>";

TEST(Boat, with_two_thrusters_goes_and_turns_as_it_is_told) {
  SimulationFixture f(world_of_text(pond + boat()));
  EXPECT_TRUE(f.dropped.empty());
  auto pilot = f.open(IfaceType::position3d, "boat::position3d");
  f.run(5);
  EXPECT_NEAR(height(f, "boat"), 0.05, 0.02) << "it floats";
  command(pilot, {1, 0, 0, 0, 0, 0});
  f.run(30);
  EXPECT_NEAR(sample(pilot).velocity[0], 1, 0.02);
  EXPECT_NEAR(sample(pilot).velocity[5], 0, 0.01);
  command(pilot, {0.5, 0, 0, 0, 0, 0.2});
  f.run(30);
  EXPECT_NEAR(sample(pilot).velocity[0], 0.5, 0.03);
  EXPECT_NEAR(sample(pilot).velocity[5], 0.2, 0.01);
  command(pilot, {0, 0, 0, 0, 0, 0});
  f.run(30);
  EXPECT_LT(std::abs(sample(pilot).velocity[0]) + std::abs(sample(pilot).velocity[5]), 0.02);
  EXPECT_NEAR(height(f, "boat"), 0.05, 0.02);
}

TEST(Boat, that_is_weak_is_slower_and_a_halted_one_goes_on_as_it_was_told) {
  SimulationFixture f(world_of_text(pond + boat()));
  auto pilot = f.open(IfaceType::position3d, "boat::position3d");
  const auto fault = [&](shm::FaultKind kind) {
    ASSERT_TRUE(f.simulation->add_fault({"boat::position3d", kind, 0.5, f.simulation->time()}));
  };
  command(pilot, {0.8, 0, 0, 0, 0, 0});
  fault(shm::FaultKind::weak);
  f.run(40);
  EXPECT_NEAR(sample(pilot).velocity[0], 0.4, 0.02);
  EXPECT_EQ(f.simulation->end_faults({}, std::nullopt), 1U);
  f.run(40);
  fault(shm::FaultKind::halted);
  command(pilot, {0, 0, 0, 0, 0, 0});
  f.run(20);
  EXPECT_NEAR(sample(pilot).velocity[0], 0.8, 0.03);
}

TEST(Boat, and_torpedo_are_the_same_after_a_reset_and_with_more_threads) {
  const auto sail = [](SimulationFixture& f) {
    auto pilot = f.open(IfaceType::position3d, "boat::position3d");
    Joints joints(f, "auv");
    command(pilot, {0.7, 0, 0, 0, 0, 0.1});
    joints.command(0, RTMSIM_JOINT_VELOCITY, 60);
    f.run(3);
    return f.simulation->hash();
  };
  std::string all = pond + boat() + torpedo("auv", torpedo_thruster, "0 5 -2 0 0 0");
  for (int i = 0; i < 8; ++i)
    all += torpedo("still" + std::to_string(i), torpedo_thruster, "0 " + std::to_string(10 + 5 * i) + " -2 0.1 0 0");
  SimulationFixture one(world_of_text(all));
  const auto hash = sail(one);
  std::vector<std::string> notes;
  ASSERT_TRUE(one.simulation->reset(notes));
  EXPECT_EQ(sail(one), hash);
  one.simulation.reset();
  one.server.reset();
  SimulationFixture many(world_of_text(all), 1, 3);
  EXPECT_EQ(sail(many), hash);
}

// As docs/worlds.md has it: goals, and how far they came. --gtest_filter=*Table* prints its rows.
TEST(VehiclesTable, vehicles_come_to_their_goals) {
  struct Row {
    std::string name, world, model;
    double ahead, turn;
  };
  for (const Row& row : {Row{"X3 of gz-sim's examples (a quadcopter)", air + flat_ground + quadcopter("x3", "0 0 5 0 0 0"), "x3", 5, 1.6},
                         Row{"a boat on two thrusters", pond + boat(), "boat", 10, 1.6}}) {
    SimulationFixture f(world_of_text(row.world));
    auto pilot = f.open(IfaceType::position3d, row.model + "::position3d");
    const std::array<double, 6> goal{row.ahead, 0, 0, 0, 0, 0}, turned{row.ahead, 0, 0, 0, 0, row.turn};
    ASSERT_TRUE(pilot.command(shm::CommandKind::pose, goal));
    f.run(60);
    const double way = sample(pilot).true_pose.x;
    ASSERT_TRUE(pilot.command(shm::CommandKind::pose, turned));
    f.run(60);
    const auto pose = sample(pilot).true_pose;
    const double yaw = 2 * std::atan2(pose.qz, pose.qw);
    fmt::print("| {} | {:g} m | {:.3f} m | {:g} rad | {:.3f} rad |\n", row.name, row.ahead, way, row.turn, yaw);
    EXPECT_NEAR(way / row.ahead, 1, 0.03) << row.name;
    EXPECT_NEAR(yaw / row.turn, 1, 0.03) << row.name;
  }
}

}  // namespace
}  // namespace sim

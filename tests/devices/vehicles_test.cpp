// Multicopters, thrusters and what commands them, against formulas: docs/worlds.md says what they do.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "support/vehicles.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

const std::string air = "<gravity>0 0 -9.81</gravity>", weightless = "<gravity>0 0 0</gravity>";
const std::string ground =
    "<model name='ground'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>";

void command(shm::Iface& iface, const std::array<double, 6>& velocity) { ASSERT_TRUE(iface.command(shm::CommandKind::velocity, velocity)); }

// A client that commands joints by their places.
struct Joints {
  Joints(SimulationFixture& f, const std::string& model) : iface(f.open(IfaceType::joints, model + "::joints")) {
    values.resize(RTMSIM_JOINT_VALUES * iface.count());
  }
  void command(std::size_t joint, std::uint32_t mode, double value) {
    values[RTMSIM_JOINT_VALUES * joint] = mode, values[RTMSIM_JOINT_VALUES * joint + 1] = value;
    ASSERT_TRUE(iface.command(shm::CommandKind::joints, values));
  }
  shm::JointState state(std::size_t joint) {
    EXPECT_TRUE(iface.read());
    return reinterpret_cast<const shm::JointState*>(iface.sample_followers(0))[joint];
  }
  const shm::Joint& info(std::size_t joint) const { return reinterpret_cast<const shm::Joint*>(iface.info_followers(0))[joint]; }
  shm::Iface iface;
  std::vector<double> values;
};

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

// --- multicopters

TEST(Multicopter, falls_until_a_client_commands_it_and_then_hovers_at_660_radians_a_second) {
  SimulationFixture f(world_of_text(air + ground + quadcopter("x3", "0 0 50 0 0 0")));
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
  SimulationFixture f(world_of_text(air + ground + quadcopter("x3", "0 0 5 0 0 0")));
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
  SimulationFixture f(world_of_text(air + ground + quadcopter("x3", "0 0 5 0 0 0", false)));
  auto pilot = f.open(IfaceType::position3d, "x3::position3d");
  command(pilot, {1, 0, 0, 0, 0, 0});
  f.run(10);
  EXPECT_NEAR(sample(pilot).velocity[0], 1, 0.1);
  command(pilot, {0, 0, 0, 0, 0, 0.5});
  f.run(10);
  EXPECT_NEAR(sample(pilot).velocity[5], 0.5, 0.05);
}

TEST(Multicopter, flies_to_a_goal_and_falls_with_its_motors_off) {
  SimulationFixture f(world_of_text(air + ground + quadcopter("x3", "1 0 5 0 0 0")));
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
  SimulationFixture f(world_of_text(air + ground + quadcopter("x3", "0 0 5 0 0 0")));
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
  std::string all = air + ground;
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

// As docs/worlds.md has it: goals, and how far they came. --gtest_filter=*Table* prints its rows.
TEST(VehiclesTable, vehicles_come_to_their_goals) {
  struct Row {
    std::string name, world, model;
    double ahead, turn;
  };
  for (const Row& row : {Row{"X3 of gz-sim's examples (a quadcopter)", air + ground + quadcopter("x3", "0 0 5 0 0 0"), "x3", 5, 1.6},
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

// --- wrenches that stay

TEST(Wrench, of_the_file_pushes_from_the_start_and_after_a_reset) {
  const std::string push =
      "<plugin filename='gz-sim-apply-link-wrench-system' "
      "name='gz::sim::systems::ApplyLinkWrench'><persistent><entity_name>box</entity_name>"
      "<entity_type>model</entity_type><force>2 0 "
      "0</force></persistent><persistent><entity_name>later::l</entity_name><entity_type>link</entity_type>"
      "<torque>0 0 1</torque></persistent></plugin>";
  const std::string box = "<model name='box'><link name='l'><inertial><mass>2</mass></inertial></link></model>";
  SimulationFixture f(world_of_text(weightless + push + box));
  ASSERT_EQ(f.notes.size(), 1U);
  EXPECT_THAT(f.notes[0], testing::HasSubstr("there is no \"later::l\" that <persistent> pushes; it is pushed when it is spawned"));
  const auto speed = [&] { return f.simulation->physics().link_twist({0, 0}).linear.x(); };
  f.run(1);
  EXPECT_NEAR(speed(), 1, 1e-6);
  ModelDef later = f.simulation->physics().def(0);
  later.name = "later", later.pose.translation() = Eigen::Vector3d(0, 5, 0);
  std::vector<std::string> notes;
  const auto spawned = f.simulation->spawn(later, notes);
  ASSERT_TRUE(spawned);
  f.run(1);
  EXPECT_NEAR(f.simulation->physics().link_twist({*spawned, 0}).angular.z(), 1, 1e-6);
  // A client takes its place, and ends it.
  ASSERT_TRUE(f.simulation->keep_wrench({0, 0}, {-4, 0, 0}, {0, 0, 0}));
  f.run(1);
  EXPECT_NEAR(speed(), 0, 1e-6);
  ASSERT_TRUE(f.simulation->keep_wrench({0, 0}, {0, 0, 0}, {0, 0, 0}));
  f.run(1);
  EXPECT_NEAR(speed(), 0, 1e-6);
  ASSERT_TRUE(f.simulation->reset(notes));
  f.run(1);
  EXPECT_NEAR(speed(), 1, 1e-6);
}

// --- wind

TEST(Wind, rises_and_swings_as_its_plugin_says) {
  const auto windy = [](const std::string& of_plugin) {
    return weightless +
           "<wind><linear_velocity>5 0 2</linear_velocity></wind><plugin filename='gz-sim-wind-effects-system' "
           "name='gz::sim::systems::WindEffects'>" +
           of_plugin +
           "</plugin><model name='kite'><enable_wind>true</enable_wind><link name='l'><inertial><mass>3</mass></inertial></link></model>";
  };
  SimulationFixture f(
      world_of_text(windy("<horizontal><magnitude><time_for_rise>2</time_for_rise></magnitude></horizontal>"
                          "<force_approximation_scaling_factor>0.5</force_approximation_scaling_factor>")));
  EXPECT_TRUE(f.dropped.empty());
  const auto velocity = [&] { return f.simulation->physics().link_twist({0, 0}).linear; };
  f.run(2);
  EXPECT_NEAR(f.simulation->physics().wind().x(), 5 * (1 - std::exp(-1)), 0.003);
  EXPECT_NEAR(velocity().x(), 5 * (1 - 2 * std::exp(-1)), 0.003);
  EXPECT_NEAR(f.simulation->physics().wind().z(), 2 * (1 - std::exp(-2)), 0.003);
  const auto hash = f.simulation->hash();
  std::vector<std::string> notes;
  ASSERT_TRUE(f.simulation->reset(notes));
  EXPECT_NEAR(f.simulation->physics().wind().x(), 5 * 0.001 / 2, 1e-12);
  f.run(2);
  EXPECT_EQ(f.simulation->hash(), hash);
  f.simulation.reset();
  f.server.reset();
  SimulationFixture swings(world_of_text(windy(
      "<horizontal><magnitude><time_for_rise>0.001</time_for_rise><sin><amplitude_percent>0.5</amplitude_percent><period>4</period></sin>"
      "<noise type='gaussian'><stddev>0.1</stddev></noise></magnitude><direction><sin><amplitude>90</amplitude><period>12</period></sin>"
      "</direction></horizontal>")));
  ASSERT_EQ(swings.dropped.size(), 1U);
  EXPECT_THAT(swings.dropped[0], testing::HasSubstr("plugin \"gz::sim::systems::WindEffects\": its <noise> is not simulated"));
  swings.run(1);
  const Eigen::Vector3d wind = swings.simulation->physics().wind();
  EXPECT_NEAR(wind.head<2>().norm(), 5 * 1.5, 0.01);
  EXPECT_NEAR(std::atan2(wind.y(), wind.x()), std::numbers::pi / 4, 0.002) << "half of 90 degrees after a twelfth of the period";
}

TEST(Wind, that_rises_moves_what_has_lain_still) {
  SimulationFixture f(world_of_text(
      air + ground +
      "<wind><linear_velocity>20 0 0</linear_velocity></wind><plugin filename='gz-sim-wind-effects-system' "
      "name='gz::sim::systems::WindEffects'><horizontal><magnitude><time_for_rise>5</time_for_rise></magnitude></horizontal></plugin>"
      "<model name='crate'><pose>0 0 0.5 0 0 0</pose><enable_wind>true</enable_wind><link "
      "name='l'><inertial><mass>2</mass><inertia><ixx>0.3</ixx>"
      "<iyy>0.3</iyy><izz>0.3</izz></inertia></inertial><collision name='c'><geometry><box><size>1 1 "
      "1</size></box></geometry><surface><friction><ode><mu>0.3</mu><mu2>0.3</mu2></ode>"
      "</friction></surface></collision></link></model>"));
  const auto place = [&] { return f.simulation->physics().model_pose(*f.simulation->physics().find("crate")).translation().x(); };
  f.run(0.5);
  EXPECT_NEAR(place(), 0, 1e-3);
  f.run(5);
  EXPECT_GT(place(), 0.5);
}

TEST(JointForce, joints_of_the_plugin_take_efforts) {
  SimulationFixture f(world_of_text(
      weightless +
      "<model name='m'><link name='a'/><link name='b'><inertial><inertia><izz>0.5</izz></inertia></inertial></link>"
      "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint><joint name='w' "
      "type='fixed'><parent>world</parent><child>a</child></joint><plugin filename='gz-sim-apply-joint-force-system' "
      "name='gz::sim::systems::ApplyJointForce'><joint_name>j</joint_name></plugin></model>"));
  EXPECT_TRUE(f.dropped.empty());
  Joints joints(f, "m");
  joints.command(0, RTMSIM_JOINT_EFFORT, 1);
  f.run(1);
  EXPECT_NEAR(joints.state(0).velocity, 2, 0.01);
}

// One line each, and the rest runs.
TEST(Vehicles, plugins_that_cannot_push_say_why) {
  const auto plugin = [](const std::string& file, const std::string& content, const std::string& name = "p") {
    return "<plugin filename='gz-sim-" + file + "-system' name='" + name + "'>" + content + "</plugin>";
  };
  const std::string rest =
      "<model name='rock'><static>true</static><link name='l'/></model><model name='m'><link name='a'/><link name='b'/><joint name='j' "
      "type='revolute'><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz></axis></joint><joint name='w' "
      "type='ball'><parent>world</parent>"
      "<child>a</child></joint>";
  const std::string propeller = "<joint_name>j</joint_name><propeller_diameter>0.1</propeller_diameter>";
  for (const auto& [of_world, of_model, expected] : {
           std::tuple{"", plugin("apply-joint-force", "<joint_name>x</joint_name>"),
                      "plugin p: model m has no joint \"x\"; the plugin is left out"},
           std::tuple{"", plugin("apply-joint-force", ""), "plugin p: model m has no joint \"\"; the plugin is left out"},
           std::tuple{"", plugin("apply-joint-force", "<joint_name>w</joint_name>"), "plugin p: joint \"w\" turns about no axis"},
           std::tuple{"", plugin("lift-drag", "<link_name>a</link_name><forward>0 0 0</forward>"),
                      "<forward> and <upward> must be two directions, got \"0 0 0\" and \"0 0 1\"; the plugin is left out"},
           std::tuple{"", plugin("lift-drag", "<link_name>a</link_name><upward>-2 0 0</upward>"),
                      "<forward> and <upward> must be two directions, got \"1 0 0\" and \"-2 0 0\"; the plugin is left out"},
           std::tuple{"", plugin("thruster", propeller + "<min_thrust_cmd>5</min_thrust_cmd><max_thrust_cmd>-5</max_thrust_cmd>"),
                      "<min_thrust_cmd> must not be more than <max_thrust_cmd>, got 5 and -5; -1000 to 1000 are taken"},
           std::tuple{"", plugin("thruster", propeller) + plugin("thruster", propeller, "q"),
                      "joint \"j\" has a propeller already; the plugin is left out"},
           std::tuple{"", plugin("multicopter-motor-model", "<jointName>j</jointName><turningDirection>left</turningDirection>"),
                      "<turningDirection> must be cw or ccw, got \"left\"; ccw is taken"},
           std::tuple{"", plugin("multicopter-motor-model", "<jointName>j</jointName><motorType>position</motorType>"),
                      "<motorType> must be velocity, got \"position\"; velocity is taken"},
           std::tuple{"", plugin("joint-state-publisher", "<joint_name>j</joint_name><joint_name>x</joint_name>"),
                      "plugin p: model m has no joint \"x\"; its state is left out"},
           std::tuple{"", plugin("odometry-publisher", "") + plugin("odometry-publisher", "", "q"), "plugin q: the model has one already"},
           std::tuple{"", plugin("track-controller", "<link>b</link>") + plugin("track-controller", "<link>b</link>", "q"),
                      "plugin q: track \"b\" is driven by p already; the plugin is left out"},
           std::tuple{"",
                      plugin("tracked-vehicle",
                             "<left_track><link>b</link></left_track><right_track><link>b</link></right_track><tracks_separation>1</"
                             "tracks_separation>"),
                      "plugin p: track \"b\" is named twice; the plugin is left out"},
           std::tuple{"", plugin("velocity-control", "<link_name>b</link_name>"),
                      "plugin p: <link_name> is ignored; the whole model moves"},
           std::tuple{"<persistent><entity_name>rock</entity_name><force>1 0 0</force></persistent>", std::string(),
                      "\"rock\", which <persistent> pushes, cannot move"},
           std::tuple{"<persistent><force>1 0 0</force></persistent>", std::string(),
                      "<persistent> needs an <entity_name> and an <entity_type> model or link, got \"\" and \"model\"; it pushes nothing"},
           std::tuple{"<persistent><entity_name>m::j</entity_name><entity_type>joint</entity_type></persistent>", std::string(),
                      "got \"m::j\" and \"joint\"; it pushes nothing"},
       }) {
    SimulationFixture f(
        world_of_text(weightless + (*of_world != 0 ? plugin("apply-link-wrench", of_world) : "") + rest + of_model + "</model>"));
    ASSERT_EQ(f.dropped.size(), 1U) << expected;
    EXPECT_THAT(f.dropped[0], testing::HasSubstr(expected));
  }
  SimulationFixture f(world_of_text(weightless + plugin("buoyancy", "<enable>whale</enable>") + rest + "</model>"));
  ASSERT_EQ(f.notes.size(), 1U);
  EXPECT_THAT(f.notes[0], testing::HasSubstr("there is no model \"whale\" that <enable> names; it is carried when it is spawned"));
}

TEST(JointForce, of_a_client_is_added_to_what_the_motor_does_and_ends_when_it_should) {
  SimulationFixture f(world_of_text(
      weightless +
      "<model name='m'><link name='a'/><link name='b'><inertial><inertia><izz>0.5</izz></inertia></inertial></link>"
      "<link name='c'><inertial><mass>2</mass></inertial></link><joint name='a' type='revolute'><parent>a</parent><child>b</child>"
      "<axis><xyz>0 0 1</xyz></axis></joint><joint name='slide' type='prismatic'><parent>a</parent><child>c</child><axis><xyz>1 0 0</xyz>"
      "</axis></joint><joint name='w' type='fixed'><parent>world</parent><child>a</child></joint></model>"));
  Simulation& s = *f.simulation;
  const auto joint = [&](const char* name) { return *s.physics().find_joint(name); };
  const auto turning = [&] { return s.physics().joint_state(joint("m::a")).velocity; };  // a link has that name, too
  EXPECT_FALSE(s.physics().find_joint("m::b"));
  EXPECT_FALSE(s.physics().find_joint("nobody::a"));
  const auto calm = s.hash();
  ASSERT_TRUE(s.add_effort(joint("m::a"), 1, std::chrono::milliseconds(500)));
  const auto pushed = s.hash();
  EXPECT_NE(pushed, calm);
  ASSERT_TRUE(s.keep_effort(joint("m::slide"), -4));
  EXPECT_NE(s.hash(), pushed);
  f.run(1);
  EXPECT_NEAR(turning(), 1 / 0.5 * 0.5, 1e-6);
  EXPECT_NEAR(s.physics().joint_state(joint("m::slide")).velocity, -4.0 / 2, 1e-6);
  ASSERT_TRUE(s.keep_effort(joint("m::slide"), 0));
  f.run(0.5);
  EXPECT_NEAR(s.physics().joint_state(joint("m::slide")).velocity, -2, 1e-6);
  // Beside a client of the joints: its effort and this one.
  Joints joints(f, "m");
  joints.command(0, RTMSIM_JOINT_EFFORT, 1);
  ASSERT_TRUE(s.add_effort(joint("m::a"), 2, std::chrono::seconds(1)));
  f.run(1);
  EXPECT_NEAR(turning(), 1 + (1 + 2) / 0.5, 0.02);
  EXPECT_EQ(s.add_effort(joint("m::w"), 1, {}).error().message, "model m: joint w neither turns nor slides");
  EXPECT_EQ(s.keep_effort(joint("m::a"), NAN).error().message, "model m: the effort of joint a must be finite and below 1e7, got nan");
  ASSERT_TRUE(s.keep_effort(joint("m::slide"), 5));
  std::vector<std::string> notes;
  ASSERT_TRUE(s.reset(notes));
  EXPECT_EQ(s.hash(), calm);
  f.run(0.1);
  EXPECT_EQ(s.physics().joint_state(joint("m::slide")).velocity, 0);
}

}  // namespace
}  // namespace sim

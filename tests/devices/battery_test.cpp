// The battery of a model against the equations of gz-sim, and what an empty one does to motors.
#include <gtest/gtest.h>

#include "shm/client.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

std::string battery(const std::string& elements) {
  return "<plugin name='gz::sim::systems::LinearBatteryPlugin' "
         "filename='gz-sim-linearbatteryplugin-system'><battery_name>pack</battery_name>" +
         elements + "</plugin>";
}

constexpr const char* full_model =
    "<voltage>12.592</voltage><open_circuit_voltage_constant_coef>12.694</open_circuit_voltage_constant_coef>"
    "<open_circuit_voltage_linear_coef>-3.1424</open_circuit_voltage_linear_coef><capacity>1.2009</capacity>"
    "<resistance>0.061523</resistance><smooth_current_tau>1.9499</smooth_current_tau><power_load>6.6</power_load><fix_issue_225>true</"
    "fix_issue_225>";

std::string rover(const std::string& plugins) {
  const auto wheel = [](const std::string& name, const std::string& y) {
    return "<link name='" + name + "'><pose>0 " + y +
           " 0 -1.5708 0 0</pose><inertial><mass>0.3</mass><inertia><ixx>.001</ixx><iyy>.001</iyy><izz>.001</izz></inertia></inertial>"
           "<collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link><joint name='" +
           name + "_wheel' type='revolute'><parent>base</parent><child>" + name + "</child><axis><xyz>0 0 1</xyz></axis></joint>";
  };
  return "<physics type='ode'><max_step_size>0.005</max_step_size></physics>"
         "<model name='ground'><static>1</static><link name='l'><collision "
         "name='c'><geometry><plane/></geometry></collision></link></model>"
         "<model name='rover'><pose>0 0 0.1 0 0 0</pose><link name='base'><inertial><mass>2</mass><inertia><ixx>.02</ixx><iyy>.02</iyy>"
         "<izz>.02</izz></inertia></inertial><collision name='c'><pose>-0.15 0 0 0 0 "
         "0</pose><geometry><sphere><radius>0.1</radius></sphere></geometry>"
         "<surface><friction><ode><mu>0</mu><mu2>0</mu2></ode></friction></surface></collision></link>" +
         wheel("left", "0.15") + wheel("right", "-0.15") +
         "<plugin name='position2d' "
         "filename='gz-sim-diff-drive-system'><left_joint>left_wheel</left_joint><right_joint>right_wheel</right_joint>"
         "<wheel_separation>0.3</wheel_separation><wheel_radius>0.1</wheel_radius></plugin>" +
         plugins + "</model>";
}

std::string post(const std::string& plugins, const std::string& step = "0.01") {
  return "<physics type='ode'><max_step_size>" + step + "</max_step_size></physics><model name='m'><static>1</static><link name='l'/>" +
         plugins + "</model>";
}

shm::BatterySample now(shm::Iface& iface) {
  EXPECT_TRUE(iface.read());
  return iface.sample<shm::BatterySample>();
}

TEST(Battery, follows_the_equations_of_gz_sim) {
  SimulationFixture f(world_of_text(post(battery(std::string(full_model) + "<start_draining>1</start_draining>"))));
  auto iface = f.open(IfaceType::battery, "m::pack");
  f.run(600);
  const auto sample = now(iface);
  EXPECT_NEAR(sample.level, 0.92724, 2e-5);
  EXPECT_NEAR(sample.voltage, 12.4327, 2e-4);
  EXPECT_NEAR(sample.current, 0.5308, 1e-4);
  EXPECT_EQ(sample.state, RTMSIM_BATTERY_DRAINS);
}

TEST(Battery, with_a_constant_voltage_loses_what_the_load_takes_and_is_empty_after_2_291_hours) {
  SimulationFixture f(
      world_of_text(post(battery("<voltage>12.592</voltage><open_circuit_voltage_constant_coef>12.592</open_circuit_voltage_constant_coef>"
                                 "<capacity>1.2009</capacity><smooth_current_tau>0</smooth_current_tau><power_load>6.6</power_load>"
                                 "<start_draining>true</start_draining>"),
                         "0.05")));
  auto iface = f.open(IfaceType::battery, "m::pack");
  f.run(600);
  EXPECT_NEAR(1 - now(iface).level, 0.07274, 2e-5);
  f.run(2.290 * 3600 - 600);
  EXPECT_EQ(now(iface).state, RTMSIM_BATTERY_DRAINS);
  f.run(0.002 * 3600);
  EXPECT_EQ(now(iface).state, RTMSIM_BATTERY_EMPTY);
}

TEST(Battery, keeps_its_charge_until_a_motor_works) {
  SimulationFixture f(world_of_text(rover(battery(full_model))));
  auto iface = f.open(IfaceType::battery, "rover::pack");
  auto drive = f.open(IfaceType::position2d, "rover::position2d");
  f.run(2);
  EXPECT_EQ(now(iface).level, 1);
  EXPECT_EQ(now(iface).state, RTMSIM_BATTERY_IDLE);
  ASSERT_TRUE(drive.command_velocity(0.1, 0, 0));
  f.run(2);
  const double level = now(iface).level;
  EXPECT_LT(level, 1);
  ASSERT_TRUE(drive.command_velocity(0, 0, 0));
  f.run(2);
  EXPECT_LT(now(iface).level, level) << "the robot stands, but it is on";
}

TEST(Battery, that_is_empty_stops_the_motors_until_a_reset) {
  SimulationFixture f(world_of_text(rover(
      battery("<voltage>12</voltage><capacity>0.001</capacity><power_load>36</power_load><smooth_current_tau>0.01</smooth_current_tau>"))));
  auto iface = f.open(IfaceType::battery, "rover::pack");
  auto drive = f.open(IfaceType::position2d, "rover::position2d");
  ASSERT_TRUE(drive.command_velocity(0.5, 0, 0));
  f.run(1);  // 3 A of 3.6 As
  ASSERT_TRUE(drive.read());
  EXPECT_NEAR(drive.sample<shm::Position2dSample>().true_velocity[0], 0.5, 0.05);
  EXPECT_EQ(now(iface).is_empty, 0U);
  f.run(1);
  EXPECT_EQ(now(iface).state, RTMSIM_BATTERY_EMPTY);
  EXPECT_EQ(now(iface).level, 0);
  ASSERT_TRUE(drive.read());
  EXPECT_EQ(drive.sample<shm::Position2dSample>().motors_enabled, 0U);
  EXPECT_EQ(drive.sample<shm::Position2dSample>().command[0], 0);
  std::vector<std::string> notes;
  ASSERT_TRUE(f.simulation->reset(notes));
  ASSERT_TRUE(drive.command_velocity(0.5, 0, 0));
  f.run(0.8);
  ASSERT_TRUE(drive.read());
  EXPECT_EQ(drive.sample<shm::Position2dSample>().motors_enabled, 1U);
  EXPECT_GT(drive.sample<shm::Position2dSample>().true_velocity[0], 0.4);
}

constexpr const char* small =
    "<voltage>12</voltage><capacity>0.001</capacity><power_load>36</power_load><smooth_current_tau>0.01</smooth_current_tau>";

TEST(Battery, that_is_empty_lets_an_arm_sink_and_what_flies_fall) {
  SimulationFixture f(world_of_text(
      "<physics type='ode'><max_step_size>0.002</max_step_size></physics>"
      "<model name='arm'><link name='post'/><joint name='foot' type='fixed'><parent>world</parent><child>post</child></joint>"
      "<link name='beam'><pose>0.2 0 0.5 0 0 "
      "0</pose><inertial><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial></link>"
      "<joint name='shoulder' type='revolute'><pose>-0.2 0 0 0 0 0</pose><parent>post</parent><child>beam</child><axis><xyz>0 -1 "
      "0</xyz><limit><lower>-1.5</lower>"
      "<upper>1.5</upper><effort>50</effort></limit></axis></joint>" +
      battery(small) +
      "</model><model name='flyer'><pose>5 0 50 0 0 0</pose><link "
      "name='l'><inertial><mass>1</mass><inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia>"
      "</inertial><collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision></link>"
      "<plugin name='position3d' filename='gz-sim-velocity-control-system'><initial_linear>0.1 0 0</initial_linear></plugin>" +
      battery(small) + "</model>"));
  auto joints = f.open(IfaceType::joints, "arm::joints");
  auto truth = f.open(IfaceType::truth, "flyer");
  ASSERT_TRUE(joints.command(shm::CommandKind::joints, std::array{double{RTMSIM_JOINT_POSITION}, 0.3, 0.0, 0.0}));
  const auto angle = [&] { return joints.read() ? joints.elements<shm::JointState>()[0].position : 9; };
  const auto height = [&] { return truth.read() ? truth.sample<shm::TruthSample>().pose.z : 9; };
  f.run(1);
  EXPECT_NEAR(angle(), 0.3, 0.02);
  EXPECT_NEAR(height(), 50, 0.1);
  f.run(1.5);
  EXPECT_LT(angle(), -0.2) << "it hangs";
  EXPECT_LT(height(), 46);
}

TEST(Battery, is_charged_while_a_client_connects_the_charger) {
  SimulationFixture f(world_of_text(post(
      battery("<voltage>12</voltage><capacity>1</capacity><initial_charge>0.5</initial_charge><power_load>5</power_load>"
              "<smooth_current_tau>0.01</smooth_current_tau><enable_recharge>true</enable_recharge><charging_time>0.1</charging_time>"),
      "0.05")));
  auto iface = f.open(IfaceType::battery, "m::pack");
  ASSERT_TRUE(iface.command(shm::CommandKind::charge, std::array{1.0}));
  f.run(36);  // a tenth of the charging time
  EXPECT_NEAR(now(iface).level, 0.6, 1e-3);
  EXPECT_EQ(now(iface).state, RTMSIM_BATTERY_CHARGES);
  EXPECT_NEAR(now(iface).current, -10, 1e-6);
  f.run(200);
  EXPECT_NEAR(now(iface).level, 1, 1e-9) << "to the end, not to nine tenths";
  EXPECT_EQ(now(iface).state, RTMSIM_BATTERY_FULL);
  ASSERT_TRUE(iface.command(shm::CommandKind::charge, std::array{0.0}));
  f.run(1);
  EXPECT_EQ(now(iface).state, RTMSIM_BATTERY_IDLE);
}

TEST(Battery, with_bad_numbers_is_left_out_with_a_line) {
  SimulationFixture f(world_of_text(post(battery("<voltage>12</voltage><power_load>5</power_load>"))));
  ASSERT_EQ(f.dropped.size() + f.notes.size(), 1U);
  EXPECT_NE((f.dropped.empty() ? f.notes : f.dropped).front().find("<capacity> must be positive [Ah], got 0"), std::string::npos);
}

TEST(Battery, carries_the_loads_of_the_plugins_that_name_it) {
  SimulationFixture f(world_of_text(
      post(battery("<voltage>12</voltage><capacity>1</capacity><power_load>5</power_load>") +
           "<plugin name='lamp' filename='libsensors.so'><battery_name>pack</battery_name><power_load>2.5</power_load></plugin>"
           "<plugin name='heater' filename='libsensors.so'><battery_name>other</battery_name><power_load>2.5</power_load></plugin>")));
  auto iface = f.open(IfaceType::battery, "m::pack");
  EXPECT_EQ(iface.info<shm::BatteryInfo>().load, 7.5);
}

}  // namespace
}  // namespace sim

// Wrenches, winds and efforts of files and clients, and the lines of plugins that cannot push.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/joint_client.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "support/vehicles.h"

namespace sim {
namespace {

using namespace test;

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
      air + flat_ground +
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

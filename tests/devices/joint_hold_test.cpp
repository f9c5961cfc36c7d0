// Arms whose controllers nobody commands: they stay where the controller plugin starts.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>

#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;
using testing::HasSubstr;

// An arm of one metre, level, that would fall; on it a wheel; and a slide along the arm.
LoadResult arm(const std::string& plugin) {
  const std::string text =
      "<sdf version='1.9'><world name='w'><model name='arm'><link name='post'/><joint name='foot' "
      "type='fixed'><parent>world</parent><child>"
      "post</child></joint><link name='beam'><pose>0.5 0 1 0 0 "
      "0</pose><inertial><mass>5</mass><inertia><ixx>0.1</ixx><iyy>0.5</iyy><izz>0.5"
      "</izz></inertia></inertial></link><joint name='shoulder' type='revolute'><pose>-0.5 0 0 0 0 0</pose><parent>post</parent><child>beam"
      "</child><axis><xyz>0 -1 0</xyz><limit><lower>-1.5</lower><upper>1.5</upper></limit></axis></joint><link name='cart'><pose>1 0 1 0 0 "
      "0"
      "</pose></link><joint name='slide' type='prismatic'><parent>beam</parent><child>cart</child><axis><xyz>1 0 0</xyz><limit><lower>-0.5"
      "</lower><upper>0.5</upper></limit></axis></joint><link name='wheel'><pose>0.5 0.3 1 0 0 0</pose></link><joint name='hub' type="
      "'continuous'><parent>beam</parent><child>wheel</child><axis><xyz>0 1 0</xyz></axis></joint>" +
      plugin + "</model></world></sdf>";
  auto loaded = load_world_text(text, std::filesystem::temp_directory_path(), "arm.sdf", ModelPath{});
  if (!loaded) throw std::runtime_error(loaded.error().message);
  return std::move(*loaded);
}

std::vector<std::string> texts(const LoadResult& loaded) {
  std::vector<std::string> lines;
  for (const Finding& finding : loaded.findings) lines.push_back(finding.text());
  return lines;
}

struct Arm {
  explicit Arm(const std::string& plugin) : f(arm(plugin).world) {}
  JointState at(const std::string& joint) {
    auto& physics = f.simulation->physics();
    return physics.joint_state({0, *joint_of(physics.def(0), {}, joint)});
  }
  SimulationFixture f;
};

TEST(JointHold, without_a_controller_the_arm_falls) {
  Arm run("");
  run.f.run(1);
  EXPECT_LT(run.at("shoulder").position, -1);
}

TEST(JointHold, a_position_controller_moves_to_its_initial_position_and_stays) {
  const std::string plugin =
      "<plugin filename='gz-sim-joint-position-controller-system' name='gz::sim::systems::JointPositionController'><joint_name>shoulder"
      "</joint_name><initial_position>0.7</initial_position></plugin>";
  EXPECT_THAT(texts(arm(plugin)), testing::ElementsAre(HasSubstr("is not commanded: its joints keep the position or speed")));
  Arm run(plugin);
  run.f.run(3);
  EXPECT_NEAR(run.at("shoulder").position, 0.7, 0.002);
  EXPECT_LT(run.at("slide").position, -0.4) << "which has no controller";
  std::vector<std::string> notes;
  ASSERT_TRUE(run.f.simulation->reset(notes));
  run.f.run(3);
  EXPECT_NEAR(run.at("shoulder").position, 0.7, 0.002) << "after a reset as well";
}

TEST(JointHold, a_trajectory_controller_holds_each_joint_at_its_own) {
  Arm run(
      "<plugin filename='gz-sim-joint-trajectory-controller-system' name='gz::sim::systems::JointTrajectoryController'><joint_name>slide"
      "</joint_name><initial_position>0.2</initial_position><joint_name>shoulder</joint_name><initial_position>-0.3</initial_position>"
      "</plugin>");
  run.f.run(3);
  EXPECT_NEAR(run.at("slide").position, 0.2, 0.002);
  EXPECT_NEAR(run.at("shoulder").position, -0.3, 0.002);
}

TEST(JointHold, a_velocity_controller_turns_as_fast_as_it_starts) {
  Arm run(
      "<plugin filename='gz-sim-joint-controller-system' name='gz::sim::systems::JointController'><joint_name>hub</joint_name>"
      "<initial_velocity>5</initial_velocity></plugin>");
  run.f.run(0.5);
  EXPECT_NEAR(run.at("hub").velocity, 5, 0.01);
}

TEST(JointHold, controllers_of_ros_hold_joints_with_limits_and_leave_wheels_alone) {
  for (const char* file :
       {"libgazebo_ros_control.so", "libgazebo_ros2_control.so", "libgz_ros2_control-system.so", "ign_ros2_control-system"}) {
    Arm run("<plugin filename='" + std::string(file) + "' name='control'/>");
    run.f.run(2);
    EXPECT_NEAR(run.at("shoulder").position, 0, 0.002) << file;
    EXPECT_NEAR(run.at("slide").position, 0, 0.002) << file;
    ASSERT_TRUE(run.f.simulation->physics().add_wrench({0, 3}, {0, 0, 0}, {0, 300, 0}));
    run.f.run(0.5);
    EXPECT_GT(std::abs(run.at("hub").velocity), 0.1) << file;
  }
}

TEST(JointHold, a_joint_that_is_not_there_is_one_line) {
  Arm run(
      "<plugin filename='gz-sim-joint-position-controller-system' name='gz::sim::systems::JointPositionController'><joint_name>elbow"
      "</joint_name></plugin>");
  EXPECT_THAT(run.f.dropped, testing::ElementsAre(HasSubstr("model arm has no joint \"elbow\"")));
}

}  // namespace
}  // namespace sim

// Cars with two steered wheels: they drive the circles that they are asked for, within the limits of their steering.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <filesystem>

#include "shm/requests.h"
#include "support/joint_client.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;

constexpr double base = 1.0, track = 0.8, radius = 0.2;  // [m]

std::string wheel(const std::string& name, const std::string& parent, double x, double y) {
  return fmt::format(
      "<link name='{0}'><pose>{2} {3} {4} -1.5708 0 0</pose><inertial><mass>3</mass><inertia><ixx>0.04</ixx><iyy>0.04</iyy><izz>0.06</izz>"
      "</inertia></inertial><collision name='c'><geometry><cylinder><radius>{4}</radius><length>0.1</length></cylinder></geometry>"
      "</collision></link><joint name='{0}_joint' type='revolute'><parent>{1}</parent><child>{0}</child><axis><xyz>0 0 1</xyz></axis>"
      "</joint>",
      name, parent, x, y, radius);
}

std::string knuckle(const std::string& side, double y) {
  return fmt::format(
      "<link name='{0}_knuckle'><pose>{1} {2} {3} 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01"
      "</izz></inertia></inertial></link><joint name='{0}_steering' type='revolute'><parent>body</parent><child>{0}_knuckle</child><axis>"
      "<xyz>0 0 1</xyz><limit><lower>-0.8</lower><upper>0.8</upper></limit></axis></joint>",
      side, base, y, radius);
}

// The origin lies between the rear wheels.
WorldDef car(const std::string& plugin, bool has_findings = false) {
  const std::string text =
      "<sdf version='1.9'><world name='w'><model name='ground'><static>true</static><link name='l'><collision name='c'><geometry><plane/>"
      "</geometry></collision></link></model><model name='car'><link name='body'><pose>0.5 0 0.35 0 0 0</pose><inertial><mass>60</mass>"
      "<inertia><ixx>4</ixx><iyy>8</iyy><izz>10</izz></inertia></inertial><collision name='c'><geometry><box><size>1.4 0.5 0.2</size></box>"
      "</geometry></collision></link>" +
      knuckle("left", track / 2) + knuckle("right", -track / 2) + wheel("front_left", "left_knuckle", base, track / 2) +
      wheel("front_right", "right_knuckle", base, -track / 2) + wheel("rear_left", "body", 0, track / 2) +
      wheel("rear_right", "body", 0, -track / 2) + plugin + "</model></world></sdf>";
  auto loaded = load_world_text(text, std::filesystem::temp_directory_path(), "car.sdf", ModelPath{});
  if (!loaded) throw std::runtime_error(loaded.error().message);
  for (const Finding& finding : loaded->findings) EXPECT_TRUE(has_findings) << finding.text();
  return std::move(loaded->world);
}

const std::string of_gz =
    "<plugin filename='gz-sim-ackermann-steering-system' "
    "name='gz::sim::systems::AckermannSteering'><left_joint>front_left_joint</left_joint>"
    "<left_joint>rear_left_joint</left_joint><right_joint>front_right_joint</right_joint><right_joint>rear_right_joint</right_joint>"
    "<left_steering_joint>left_steering</left_steering_joint><right_steering_joint>right_steering</right_steering_joint>"
    "<kingpin_width>0.8</kingpin_width><wheel_base>1.0</wheel_base><wheel_separation>0.8</wheel_separation><steering_limit>0.5"
    "</steering_limit><wheel_radius>0.2</wheel_radius><max_velocity>3</max_velocity><max_acceleration>2</max_acceleration></plugin>";
const std::string of_ros =
    "<plugin filename='libgazebo_ros_ackermann_drive.so' name='drive'><front_left_joint>front_left_joint</front_left_joint>"
    "<front_right_joint>front_right_joint</front_right_joint><rear_left_joint>rear_left_joint</rear_left_joint><rear_right_joint>"
    "rear_right_joint</rear_right_joint><left_steering_joint>left_steering</left_steering_joint><right_steering_joint>right_steering"
    "</right_steering_joint><max_steer>0.6458</max_steer><max_speed>20</max_speed></plugin>";

struct CarRide {
  explicit CarRide(const std::string& plugin, const std::string& name) : f(car(plugin)), drive(f.open(shm::IfaceType::position2d, name)) {}
  shm::Position2dSample after(double seconds) {
    f.run(seconds);
    EXPECT_TRUE(drive.read());
    return drive.sample<shm::Position2dSample>();
  }
  SimulationFixture f;
  shm::Iface drive;
};

TEST(CarDrive, goes_round_in_the_circle_that_it_is_asked_for) {
  for (const auto& [plugin, name] : {std::pair{of_gz, "car::position2d"}, {of_ros, "car::drive"}}) {
    CarRide ride(plugin, name);
    EXPECT_EQ(ride.drive.info<shm::Position2dInfo>().drive, RTMSIM_DRIVE_CAR);
    EXPECT_NEAR(ride.drive.info<shm::Position2dInfo>().wheel_separation, track, 1e-9);
    EXPECT_NEAR(ride.drive.info<shm::Position2dInfo>().wheel_radius, radius, 1e-9);
    ASSERT_TRUE(ride.drive.command_velocity(1, 0, 0.4));
    const auto begin = ride.after(8);  // gz-sim's steering comes slowly
    const auto end = ride.after(10);
    EXPECT_NEAR(end.true_velocity[0], 1, 0.02) << name;
    EXPECT_NEAR(end.true_velocity[2], 0.4, 0.008) << name;
    EXPECT_NEAR(end.true_velocity[1], 0, 0.02) << name << ", the rear wheels do not slip";
    const double heading = shm::yaw_of(begin.true_pose), turned = 0.4 * 10;
    const double x = begin.true_pose.x + 2.5 * (std::sin(heading + turned) - std::sin(heading));
    const double y = begin.true_pose.y - 2.5 * (std::cos(heading + turned) - std::cos(heading));
    EXPECT_NEAR(end.true_pose.x, x, 0.2) << name << ", 2 % of the 10 m";
    EXPECT_NEAR(end.true_pose.y, y, 0.2) << name;
    EXPECT_NEAR(std::remainder(end.odometry[2] - begin.odometry[2] - turned, 2 * M_PI), 0, 0.08) << name;
    EXPECT_NEAR(end.velocity[0], 1, 0.01) << name;
  }
}

TEST(CarDrive, steers_no_further_than_its_limit_and_never_on_the_spot) {
  CarRide ride(of_gz, "car::position2d");
  ASSERT_TRUE(ride.drive.command_velocity(0, 0, 1));
  const auto parked = ride.after(5);
  EXPECT_NEAR(shm::yaw_of(parked.true_pose), 0, 0.02);
  EXPECT_NEAR(parked.true_pose.x, 0, 0.02);
  ASSERT_TRUE(ride.drive.command_velocity(-1, 0, -9));
  const auto backward = ride.after(5);
  EXPECT_NEAR(backward.true_velocity[0], -1, 0.02);
  EXPECT_NEAR(backward.true_velocity[2], -std::sin(0.5) / base, 0.02);
}

TEST(CarDrive, keeps_to_its_acceleration_and_top_speed) {
  CarRide ride(of_gz, "car::position2d");
  ASSERT_TRUE(ride.drive.command_velocity(9, 0, 0));
  EXPECT_NEAR(ride.after(1).true_velocity[0], 2, 0.1);
  EXPECT_NEAR(ride.after(2).true_velocity[0], 3, 0.06);
  ASSERT_TRUE(ride.drive.command_velocity(0, 0, 0));
  EXPECT_NEAR(ride.after(0.5).true_velocity[0], 2, 0.1);
}

// gz-sim's <steering_only>: the plugin steers, JointController turns the wheels as told, whatever that takes.
TEST(CarDrive, that_only_steers_leaves_its_wheels_to_controllers_of_joints) {
  const std::string steering =
      "<plugin filename='gz-sim-ackermann-steering-system' name='gz::sim::systems::AckermannSteering'><steering_only>true</steering_only>"
      "<left_steering_joint>left_steering</left_steering_joint><right_steering_joint>right_steering</right_steering_joint>"
      "<wheel_base>1.0</wheel_base><wheel_separation>0.8</wheel_separation><steering_limit>0.5</steering_limit><steer_p_gain>5"
      "</steer_p_gain></plugin><plugin filename='gz-sim-joint-controller-system' name='gz::sim::systems::JointController'>"
      "<joint_name>rear_left_joint</joint_name></plugin><plugin filename='gz-sim-joint-controller-system' "
      "name='gz::sim::systems::JointController'><joint_name>rear_right_joint</joint_name></plugin>";
  SimulationFixture f(car(steering, true));
  EXPECT_TRUE(f.dropped.empty()) << f.dropped.front();
  auto drive = f.open(shm::IfaceType::position2d, "car::position2d");
  Joints joints(f, "car");
  for (std::size_t i = 0; i < joints.iface.count(); ++i) {
    if (std::string(joints.info(i).name).starts_with("rear_")) joints.command(i, RTMSIM_JOINT_VELOCITY, 1 / radius);
  }
  f.run(3);
  ASSERT_TRUE(drive.read());
  EXPECT_NEAR(drive.sample<shm::Position2dSample>().true_velocity[0], 1, 0.02) << "faster than the 2 rad/s of other joints";
  EXPECT_NEAR(shm::yaw_of(drive.sample<shm::Position2dSample>().true_pose), 0, 0.02);
  std::vector<double> car_command{0, 0.3};
  ASSERT_TRUE(drive.command(shm::CommandKind::car, car_command));
  f.run(4);
  ASSERT_TRUE(drive.read());
  const auto seen = drive.sample<shm::Position2dSample>();
  EXPECT_GT(seen.true_velocity[2], 0.25)
      << "1 m/s at 0.3 rad over 1 m are 0.309 rad/s with a differential; these wheels turn alike and slip";
  EXPECT_LT(seen.true_velocity[2], 0.309);
  EXPECT_EQ(seen.stalled, 0U);
  EXPECT_EQ(seen.odometry[0], 0) << "it does not know its wheels";
}

TEST(CarDrive, without_its_joints_is_one_line) {
  std::string plugin = of_gz;
  plugin.replace(plugin.find("left_steering<"), 14, "nowhere<");
  SimulationFixture f(car(plugin));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_NE(f.dropped[0].find("has no joint \"nowhere\""), std::string::npos) << f.dropped[0];
}

}  // namespace
}  // namespace sim

// Robots that people use with Gazebo drive as far and turn as much as they are told: bodies of our own with the wheels, casters, masses and
// frictions that their models have, in the worlds that they come with. docs/worlds.md shows the table that this prints with
// --gtest_filter=*Table*.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "devices/drives/traction.h"
#include "support/land_robots.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;

struct Wheel {
  double x = 0, y = 0, radius = 0, width = 0, mass = 1, inertia = 0.001;
  std::string surface, parent = "base";
  double roll = -1.5708;  // of the cylinder; models write -1.57 and 1.5707, too
  double sink = 0;        // of the wheel's lowest point below the floor at the start [m]
  double inwards = 0;     // of its joint from its middle [m]
};
struct Ball {
  double x = 0, y = 0, radius = 0, above = 0;  // lowest point over the floor at the start [m]
  std::string surface;
};
struct Robot {
  std::string name, physics;
  double mass = 1, length = 0, width = 0, height = 0, clearance = 0;  // of the body, a box
  double body_x = 0;
  std::vector<Wheel> wheels;
  std::vector<Ball> balls;
  std::string more, plugin;
  double turns = 1;  // share of the yaw that is asked for, by Coulomb's law
  bool is_car = false;
  bool gives_inertias = true;
  bool has_bare_wheels = false;  // without <inertial>
  std::string whole = {};        // the text of the model, of robots with other wheels
};

std::string inertial(double mass, double ixx, double iyy, double izz, const std::string& pose = "0 0 0 0 0 0") {
  return fmt::format("<inertial><pose>{}</pose><mass>{}</mass><inertia><ixx>{}</ixx><iyy>{}</iyy><izz>{}</izz></inertia></inertial>", pose,
                     mass, ixx, iyy, izz);
}

std::string only_mass(double mass, const std::string& pose = "0 0 0 0 0 0") {
  return fmt::format("<inertial><pose>{}</pose><mass>{}</mass></inertial>", pose, mass);
}

std::string surface(const std::string& friction, const std::string& contact = "") {
  std::string text = "<surface><friction><ode>" + friction + "</ode></friction>";
  if (!contact.empty()) text += "<contact><ode>" + contact + "</ode></contact>";
  return text + "</surface>";
}

std::string text_of(const Robot& r) {
  if (!r.whole.empty()) return r.whole;
  const double z = r.clearance + r.height / 2;
  const std::string middle = fmt::format("{} 0 {} 0 0 0", r.body_x, z);
  std::string text = "<model name='robot'><link name='base'>" +
                     (r.gives_inertias ? inertial(r.mass, r.mass * (r.width * r.width + r.height * r.height) / 12,
                                                  r.mass * (r.length * r.length + r.height * r.height) / 12,
                                                  r.mass * (r.length * r.length + r.width * r.width) / 12, middle)
                                       : only_mass(r.mass, middle)) +
                     fmt::format(
                         "<collision name='body'><pose>{} 0 {} 0 0 0</pose><geometry><box><size>{} {} {}</size></box></geometry>"
                         "</collision>",
                         r.body_x, z, r.length, r.width, r.height);
  for (std::size_t i = 0; i < r.balls.size(); ++i) {
    const Ball& b = r.balls[i];
    text += fmt::format(
        "<collision name='ball_{}'><pose>{} {} {} 0 0 0</pose><geometry><sphere><radius>{}</radius></sphere></geometry>{}"
        "</collision>",
        i, b.x, b.y, b.above + b.radius, b.radius, b.surface);
  }
  text += "</link>" + r.more;
  for (std::size_t i = 0; i < r.wheels.size(); ++i) {
    const Wheel& w = r.wheels[i];
    // In the wheel's frame, whose z axis is the axle and looks to the left or to the right.
    const std::string place = w.inwards == 0 ? "" : fmt::format("<pose>0 0 {} 0 0 0</pose>", std::copysign(w.inwards, w.y * w.roll));
    text += fmt::format("<link name='wheel_{0}'><pose>{1} {2} {3} {4} 0 0</pose>", i, w.x, w.y, w.radius - w.sink, w.roll) +
            (r.has_bare_wheels  ? ""
             : r.gives_inertias ? inertial(w.mass, w.inertia, w.inertia, w.inertia)
                                : only_mass(w.mass)) +
            fmt::format(
                "<collision name='c'><geometry><cylinder><radius>{}</radius><length>{}</length></cylinder></geometry>{}</collision>"
                "</link><joint name='wheel_{}_joint' type='revolute'>{}<parent>{}</parent><child>wheel_{}</child><axis><xyz>0 0 {}"
                "</xyz></axis></joint>",
                w.radius, w.width, w.surface, i, place, w.parent, i, w.roll < 0 ? 1 : -1);
  }
  return text + r.plugin + "</model>";
}

std::string diff_drive(const std::string& left, const std::string& right, double separation, double radius, const std::string& more) {
  std::string text = "<plugin name='drive' filename='libgazebo_ros_diff_drive.so'>";
  for (const char wheel : left) text += fmt::format("<left_joint>wheel_{}_joint</left_joint>", wheel);
  for (const char wheel : right) text += fmt::format("<right_joint>wheel_{}_joint</right_joint>", wheel);
  return text +
         fmt::format("<wheel_separation>{}</wheel_separation><wheel_diameter>{}</wheel_diameter>{}</plugin>", separation, 2 * radius, more);
}

const std::string hard = "<mu>100000</mu><mu2>100000</mu2>";
const std::string frictionless = "<mu>0</mu><mu2>0</mu2>";
const std::string of_turtlebot = "<kp>1e5</kp><kd>1</kd><max_vel>0.01</max_vel><min_depth>0.001</min_depth>";
const std::string quick_with_layer =
    "<physics type='ode'><max_step_size>0.001</max_step_size><ode><solver><type>quick</type><iters>150</iters><sor>1.4</sor></solver>"
    "<constraints><cfm>0.00001</cfm><erp>0.2</erp><contact_max_correcting_vel>2000</contact_max_correcting_vel>"
    "<contact_surface_layer>0.01</contact_surface_layer></constraints></ode></physics>";

Robot burger() {
  Robot r{"TurtleBot3 burger", quick_with_layer, 0.94, 0.14, 0.14, 0.14, 0.010, -0.032, {}, {}, {}, {}};
  for (const double y : {0.08, -0.08}) {
    r.wheels.push_back({0, y, 0.033, 0.018, 0.0285, 0.0018, surface(hard + "<fdir1>0 0 0</fdir1>", of_turtlebot), "base", -1.57});
  }
  r.balls = {{-0.081, 0, 0.005, 0.001, surface(frictionless, of_turtlebot)}};
  r.plugin = diff_drive("0", "1", 0.16, 0.033, "<max_wheel_torque>20</max_wheel_torque><max_wheel_acceleration>1</max_wheel_acceleration>");
  return r;
}

Robot waffle() {
  Robot r{"TurtleBot3 waffle", quick_with_layer, 1.52, 0.265, 0.265, 0.089, 0.0135, -0.064, {}, {}, {}, {}};
  for (const double y : {0.144, -0.144}) {
    r.wheels.push_back({0, y, 0.033, 0.018, 0.1, 2e-5, surface(hard + "<fdir1>0 0 0</fdir1>", of_turtlebot), "base", -1.57});
  }
  for (const double y : {0.064, -0.064}) r.balls.push_back({-0.177, y, 0.005, 0.001, surface(frictionless, of_turtlebot)});
  r.plugin =
      diff_drive("0", "1", 0.287, 0.033, "<max_wheel_torque>20</max_wheel_torque><max_wheel_acceleration>1</max_wheel_acceleration>");
  return r;
}

Robot turtlebot4() {
  Robot r{"TurtleBot4", "<physics type='ode'><max_step_size>0.003</max_step_size></physics>",
          3.3,          0.23,
          0.23,         0.06,
          0.03,         0.02,
          {},           {},
          {},           {}};
  for (const double y : {0.1165, -0.1165}) r.wheels.push_back({0, y, 0.03575, 0.021, 0.1, 1e-4, surface("<mu>1</mu><mu2>1</mu2>")});
  r.balls = {{0.125, 0, 0.011, 0, surface(frictionless)}};
  r.plugin =
      "<plugin filename='gz-sim-diff-drive-system' name='gz::sim::systems::DiffDrive'><left_joint>wheel_0_joint</left_joint>"
      "<right_joint>wheel_1_joint</right_joint><wheel_separation>0.233</wheel_separation><wheel_radius>0.03575</wheel_radius>"
      "<max_linear_acceleration>0.9</max_linear_acceleration></plugin>";
  return r;
}

Robot pioneer2dx() {
  Robot r{"Pioneer 2DX", "", 5, 0.445, 0.277, 0.17, 0.075, 0, {}, {}, {}, {}};
  for (const double y : {0.17, -0.17}) {
    r.wheels.push_back(
        {0.1, y, 0.11, 0.05, y > 0 ? 0.5 : 0.1, 0, surface(hard + "<slip1>0</slip1><slip2>0</slip2>"), "base", 1.5707, 0, 0.03});
  }
  r.gives_inertias = false;
  r.balls = {{-0.2, 0, 0.04, 0, surface(frictionless + "<slip1>1</slip1><slip2>1</slip2>")}};
  r.plugin =
      "<plugin filename='libDiffDrivePlugin.so' name='drive'><left_joint>wheel_0_joint</left_joint><right_joint>wheel_1_joint"
      "</right_joint><torque>5</torque></plugin>";
  return r;
}

Robot pioneer3at() {
  Robot r{"Pioneer 3AT", "", 14, 0.501, 0.4, 0.19, 0.075, 0, {}, {}, {}, {}};
  r.width = 0.32;  // between its wheels
  for (const double x : {0.125, -0.125}) {
    for (const double y : {0.201, -0.201}) {
      r.wheels.push_back({x, y, 0.11, 0.075, 1, 0.01, surface("<mu>1</mu><mu2>1</mu2><slip1>0.5</slip1><slip2>0</slip2>"), "base", 1.5707});
    }
  }
  r.plugin =
      "<plugin name='drive' filename='libSkidSteerDrivePlugin.so'><left_front>wheel_0_joint</left_front><right_front>wheel_1_joint"
      "</right_front><left_rear>wheel_2_joint</left_rear><right_rear>wheel_3_joint</right_rear></plugin>";
  return r;
}

Robot husky() {
  Robot r{"Husky", "", 46, 0.99, 0.4, 0.25, 0.13, 0, {}, {}, {}, {}};
  for (const double x : {0.256, -0.256}) {
    for (const double y : {0.2854, -0.2854}) {
      r.wheels.push_back(
          {x, y, 0.1651, 0.1143, 2.637, 0.03, surface("<mu>1</mu><mu2>1</mu2><fdir1>1 0 0</fdir1>", "<kp>1e7</kp><kd>1</kd>")});
    }
  }
  r.plugin = diff_drive("02", "13", 0.5708, 0.1651, "<max_wheel_torque>200</max_wheel_torque>");
  r.turns = 0.2854 * 0.2854 / (0.2854 * 0.2854 + 0.256 * 0.256);
  return r;
}

Robot create() {
  Robot r{"Create", "", 2.234, 0.22, 0.22, 0.061, 0.018, 0, {}, {}, {}, {}};
  for (const double y : {0.13, -0.13}) {
    r.wheels.push_back({0, y, 0.033, 0.023, 0.01, 0.001, surface("<mu>10</mu><mu2>10</mu2>"), "base", 1.5707, 0.001});
  }
  r.balls = {{0.13, 0, 0.018, -0.001, surface(frictionless)}, {-0.13, 0, 0.015, 0.002, surface(frictionless)}};
  r.plugin = diff_drive("0", "1", 0.26, 0.033, "<torque>1</torque>");
  return r;
}

// Four casters with two wheels each; pushed over the floor as its own base is by PlanarMove.
Robot pr2_base() {
  Robot r{"PR2 base", "", 118, 0.65, 0.65, 0.2, 0.12, -0.06, {}, {}, {}, {}};
  int caster = 0;
  for (const double x : {0.2246, -0.2246}) {
    for (const double y : {0.2246, -0.2246}) {
      const std::string name = fmt::format("caster_{}", caster++);
      r.more += fmt::format("<link name='{0}'><pose>{1} {2} 0.0748 0 0 0</pose>", name, x, y) + inertial(3.473, 0.0124, 0.0152, 0.0118) +
                fmt::format(
                    "</link><joint name='{0}_joint' type='continuous'><parent>base</parent><child>{0}</child><axis><xyz>0 0 1</xyz>"
                    "</axis></joint>",
                    name);
      for (const double side : {0.049, -0.049}) r.wheels.push_back({x, y + side, 0.074792, 0.034, 0.44, 0.012, "", name});
    }
  }
  r.plugin = "<plugin name='drive' filename='libgazebo_ros_planar_move.so'/>";
  return r;
}

Robot car() {
  Robot r{"car", "", 1326, 3.9, 1.2, 0.6, 0.25, 1.4, {}, {}, {}, {}};
  const std::string tyre = surface("<mu>0.9</mu><mu2>1.1</mu2><fdir1>0 0 1</fdir1>", "<min_depth>0.005</min_depth><kp>1e8</kp>");
  for (const auto& [name, y] : {std::pair{"left", 0.79}, {"right", -0.79}}) {
    r.more += fmt::format("<link name='{0}'><pose>2.86 {1} 0.3125 0 0 0</pose>", name, y) + inertial(5, 0.1, 0.1, 0.1) +
              fmt::format(
                  "</link><joint name='{0}_steering' type='revolute'><parent>base</parent><child>{0}</child><axis><xyz>0 0 1</xyz>"
                  "<limit><lower>-0.8</lower><upper>0.8</upper></limit></axis></joint>",
                  name);
    r.wheels.push_back({2.86, y, 0.3125, 0.15, 11, 0.58, tyre, name});
  }
  for (const double y : {0.79, -0.79}) r.wheels.push_back({0, y, 0.3125, 0.15, 11, 0.58, tyre});
  r.plugin =
      "<plugin filename='gz-sim-ackermann-steering-system' name='gz::sim::systems::AckermannSteering'><left_joint>wheel_2_joint"
      "</left_joint><right_joint>wheel_3_joint</right_joint><left_steering_joint>left_steering</left_steering_joint>"
      "<right_steering_joint>right_steering</right_steering_joint><kingpin_width>1.58</kingpin_width><wheel_base>2.86</wheel_base>"
      "<wheel_separation>1.58</wheel_separation><wheel_radius>0.3125</wheel_radius><steering_limit>0.6</steering_limit><steer_p_gain>20</"
      "steer_p_gain></plugin>";
  r.is_car = true;
  return r;
}

// Robots of tests/support, called as all of these.
Robot other(const std::string& name, std::string text) {
  Robot r{name, "", 1, 0, 0, 0, 0, 0, {}, {}, {}, {}};
  const std::size_t begin = text.find("name='") + 6;
  r.whole = text.replace(begin, text.find('\'', begin) - begin, "robot");
  return r;
}

const std::vector<Robot>& robots() {
  static const std::vector<Robot> all{burger(),
                                      waffle(),
                                      turtlebot4(),
                                      pioneer2dx(),
                                      pioneer3at(),
                                      husky(),
                                      create(),
                                      pr2_base(),
                                      car(),
                                      other("mecanum base", mecanum_text()),
                                      other("omni base", omni_text()),
                                      other("tracked robot", tracked_text())};
  return all;
}

struct Ride {
  explicit Ride(const Robot& robot, double yaw = 0) : f(world(robot, yaw)) {
    for (const auto& device : f.simulation->devices()) {
      const auto type = device->iface().type();
      if (type == shm::IfaceType::position2d || type == shm::IfaceType::position3d) drive = f.open(type, device->iface().name());
    }
    f.run(1);  // comes to rest on its wheels
    rest = pose();
  }
  static WorldDef world(const Robot& robot, double yaw) {
    std::string text = "<sdf version='1.9'><world name='w'>" + robot.physics +
                       "<model name='ground'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry>"
                       "</collision></link></model>" +
                       text_of(robot) + "</world></sdf>";
    auto loaded = load_world_text(text, std::filesystem::temp_directory_path(), "robot.sdf", ModelPath{});
    if (!loaded) throw std::runtime_error(loaded.error().message);
    EXPECT_EQ(loaded->findings.size(), (robot.gives_inertias ? 0U : 1U) + (robot.has_bare_wheels ? 1U : 0U));
    for (const Finding& finding : loaded->findings) {
      if ((robot.gives_inertias && !robot.has_bare_wheels) || finding.severity != Finding::Severity::note) ADD_FAILURE() << finding.text();
    }
    for (ModelDef& model : loaded->world.models) {
      if (model.name == "robot") model.pose = at(0, 0, 0, yaw);
    }
    return std::move(loaded->world);
  }
  Eigen::Isometry3d pose() { return f.simulation->physics().model_pose(f.simulation->physics().find("robot").value()); }
  // The yaw that it has turned by, with whole turns [rad], and the way it has gone [m].
  void go(double vx, double va, double seconds) {
    travelled = turned = 0;
    for (const auto& [v, w, time] : {std::tuple{vx, va, seconds}, {0.0, 0.0, 2.0}}) {
      const bool flies = drive->type() == shm::IfaceType::position3d;
      const double six[6] = {v, 0, 0, 0, 0, w};
      const auto sent = flies ? drive->command(shm::CommandKind::velocity, six) : drive->command_velocity(v, 0, w);
      if (!sent) throw std::runtime_error("the command was not taken");
      const double dt = f.simulation->world().physics.step;
      const auto steps = static_cast<int>(std::lround(time / dt));
      for (int i = 0; i < steps; i += 25) {
        const Eigen::Isometry3d before = pose();
        for (int k = i; k < std::min(i + 25, steps); ++k) f.simulation->step(f.times);
        const Eigen::Vector3d step = pose().translation() - before.translation();
        travelled += std::copysign(step.head<2>().norm(), step.dot(before.linear().col(0)));
        turned += std::remainder(yaw_of(pose()) - yaw_of(before), 2 * M_PI);
      }
    }
  }
  SimulationFixture f;
  std::optional<shm::Iface> drive;
  Eigen::Isometry3d rest;
  double travelled = 0, turned = 0;
};

class RealRobots : public ::testing::TestWithParam<std::size_t> {};

TEST_P(RealRobots, travel_and_turn_as_far_as_they_are_told_wherever_they_look) {
  const Robot& robot = robots()[GetParam()];
  const double speed = robot.is_car ? 1 : 0.2, rate = robot.is_car ? 0.2 : 0.5;
  for (const double yaw : {0.0, 0.7, M_PI / 2}) {
    auto ride = std::make_unique<Ride>(robot, yaw);
    EXPECT_LT(std::abs(ride->rest.translation().z()), 0.0025) << robot.name << " stands on its wheels";
    ride->go(speed, 0, 5);
    const double travelled = ride->travelled;
    EXPECT_NEAR(travelled, 5 * speed, 0.03 * 5 * speed) << robot.name << " looks along " << yaw;
    EXPECT_NEAR(ride->turned, 0, 0.03) << robot.name;
    ride.reset();
    ride = std::make_unique<Ride>(robot, yaw);
    ride->go(robot.is_car ? speed : 0, rate, 8);
    const double expected = 8 * rate * robot.turns;
    EXPECT_NEAR(ride->turned, expected, 0.03 * expected) << robot.name << " looks along " << yaw;
    const std::string told =
        fmt::format("| {} | 1.00 m | {:.3f} m | {:.2f} rad | {:.3f} rad |", robot.name, travelled / speed / 5, expected, ride->turned);
    if (yaw == 0) RecordProperty("row", told), std::printf("%s\n", told.c_str());
  }
}

INSTANTIATE_TEST_SUITE_P(Table, RealRobots, ::testing::Range<std::size_t>(0, 12), [](const auto& parameter) {
  std::string name = robots()[parameter.param].name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

// Where the robot is every 0.1 s of ten seconds of curves, straight ways and stops; and for how much of that it was in the rolling step.
struct Tour {
  std::vector<Eigen::Isometry3d> poses;
  std::vector<std::array<double, 6>> drive;  // odometry and velocity
  double rolled = 0;
};

Tour tour(const Robot& robot, bool rolling, double speed, double rate) {
  Ride ride(robot, 0.7);
  Physics& physics = ride.f.simulation->physics();
  physics.let_roll(rolling);
  ride.f.run(1);
  Tour tour;
  constexpr std::array<std::array<double, 2>, 5> legs{{{1, 0}, {1, 0.6}, {0.5, -1}, {0, 1}, {-1, 0.3}}};
  for (int tenth = 0; tenth < 100; ++tenth) {
    const auto& leg = legs[static_cast<std::size_t>(tenth / 20)];
    if (tenth % 20 == 0 && !ride.drive->command_velocity(leg[0] * speed, 0, leg[1] * rate)) throw std::runtime_error("no command");
    ride.f.run(0.1);
    tour.poses.push_back(ride.pose());
    EXPECT_TRUE(ride.drive->read());
    const auto& s = ride.drive->sample<shm::Position2dSample>();
    tour.drive.push_back({s.odometry[0], s.odometry[1], s.odometry[2], s.velocity[0], s.velocity[1], s.velocity[2]});
    tour.rolled += physics.statistics().rolling == 1 ? 0.01 : 0;
  }
  return tour;
}

// Metres and radians by which two tours differ at most.
std::pair<double, double> difference(const Tour& a, const Tour& b) {
  double away = 0, turned = 0;
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    away = std::max(away, (a.poses[i].translation() - b.poses[i].translation()).norm());
    turned = std::max(turned, Eigen::AngleAxisd(a.poses[i].linear().transpose() * b.poses[i].linear()).angle());
  }
  return {away, turned};
}

TEST_P(RealRobots, are_where_ode_has_them_after_ten_seconds_of_the_rolling_step) {
  const Robot& robot = robots()[GetParam()];
  if (robot.name == "PR2 base") return;
  const double speed = robot.is_car ? 1 : 0.2, rate = robot.is_car ? 0.2 : 0.5;
  const Tour ode = tour(robot, false, speed, rate), rolling = tour(robot, true, speed, rate);
  const auto [away, turned] = difference(ode, rolling);
  EXPECT_LT(away, 0.001) << robot.name;
  EXPECT_LT(turned, 0.1 / 180 * M_PI) << robot.name;
  double encoders = 0;
  for (std::size_t i = 0; i < ode.drive.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) encoders = std::max(encoders, std::abs(ode.drive[i][k] - rolling.drive[i][k]));
  }
  EXPECT_LT(encoders, 0.001) << robot.name;
  std::printf("%-20s rolled %.2f of the time; %.3f mm, %.4f deg, odometry %.3f mm\n", robot.name.c_str(), rolling.rolled, away * 1e3,
              turned / M_PI * 180, encoders * 1e3);
}

// With the specification's 1 kg m^2 for each of its wheels of 0.5 and 0.1 kg it nods when it stops, rolls back, and at 0.5 m/s falls over.
TEST(RobotWithoutInertias, drives_and_stops_as_it_is_told_fast_and_slowly) {
  for (const double speed : {0.2, 0.5, -0.2, -0.5}) {
    Ride ride(pioneer2dx());
    ride.go(speed, 0, 5);
    EXPECT_NEAR(ride.travelled, 5 * speed, 0.03 * 5 * std::abs(speed)) << speed << " m/s";
    EXPECT_NEAR(ride.turned, 0, 0.03) << speed << " m/s";
    EXPECT_GT(ride.pose().linear()(2, 2), 0.999) << "stands upright after " << speed << " m/s";
  }
  for (const double rate : {0.5, -0.5, 1.0}) {
    Ride ride(pioneer2dx());
    ride.go(0, rate, 8);
    EXPECT_NEAR(ride.turned, 8 * rate, 0.03 * 8 * std::abs(rate)) << rate << " rad/s";
  }
}

// With the specification's 1 kg m^2 for each wheel a burger turned 0.84 of 1 rad: its tyres cannot speed that up.
TEST(RobotWithoutInertias, turns_as_it_is_told_on_wheels_without_inertial) {
  Robot robot = burger();
  robot.has_bare_wheels = true;
  Ride ride(robot);
  ride.go(0, 1, 1);
  EXPECT_NEAR(ride.turned, 1, 0.05);
  ride.go(0.2, 0, 5);
  EXPECT_NEAR(ride.travelled, 1, 0.03);
}

TEST(Traction, a_robot_whose_belly_lies_on_the_floor_is_stalled) {
  Robot robot = burger();
  robot.clearance = -0.001;
  Ride ride(robot);
  ASSERT_TRUE(ride.drive->command_velocity(0.2, 0, 0));
  ride.f.run(3);
  ASSERT_TRUE(ride.drive->read());
  EXPECT_EQ(ride.drive->sample<shm::Position2dSample>().stalled, 1U);
  ASSERT_TRUE(ride.drive->command_velocity(0, 0, 0));
  ride.f.run(1);
  ASSERT_TRUE(ride.drive->read());
  EXPECT_EQ(ride.drive->sample<shm::Position2dSample>().stalled, 0U);
}

TEST(Traction, tells_once_of_wheels_that_slip_until_they_grip_again) {
  Traction traction(0.3, false);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  int lines = 0;
  const auto drive = [&](double seconds, double share) {
    for (int i = 0; i < std::lround(seconds / 0.01); ++i) {
      pose.translation().x() += 0.3 * 0.01 * share;
      if (traction.follow({0.3, 0}, {0.3 * 0.01, 0, 0.3, 0}, 0.01) && !traction.look(pose).empty()) ++lines;
    }
  };
  drive(2, 0.1);
  EXPECT_EQ(lines, 0) << "not at once";
  EXPECT_TRUE(traction.is_stalled());
  drive(20, 0.1);
  EXPECT_EQ(lines, 1);
  drive(2, 1);
  EXPECT_FALSE(traction.is_stalled());
  drive(10, 0.3);
  EXPECT_EQ(lines, 2);
  EXPECT_FALSE(traction.is_stalled()) << "it moves, if slowly";
}

}  // namespace
}  // namespace sim

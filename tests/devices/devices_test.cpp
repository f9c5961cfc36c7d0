// Devices against what physics and geometry say.
#include <gtest/gtest.h>

#include <cmath>

#include "devices/sensors/gps.h"
#include "shm/requests.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

WorldDef world_of(std::vector<ModelDef> models, double step = 0.001) {
  WorldDef world;
  world.physics.step = step;
  world.models = std::move(models);
  return world;
}

ParameterNode& parameter(ModelDef& model, const std::string& name) {
  for (auto& child : model.plugins[0].parameters.children) {
    if (child.name == name) return child;
  }
  throw std::runtime_error(name);
}

TEST(Position2d, a_robot_on_a_curve_ends_within_two_percent_of_the_closed_form) {
  SimulationFixture f(world_of({ground(), pioneer("robot", at(0, 0, 0))}));
  auto drive = f.open(IfaceType::position2d, "robot::position2d");
  ASSERT_TRUE(drive.command_velocity(0.3, 0, 0.5));
  f.run(10);
  ASSERT_TRUE(drive.read());
  const auto& s = drive.sample<shm::Position2dSample>();
  // It speeds up with 1 m/s^2 at the outer wheel, on the curve: that costs half the time of the ramp.
  const double ramp = (0.3 + 0.5 * 0.165) / 1.0, angle = 0.5 * (10 - ramp / 2), radius = 0.3 / 0.5, path = radius * angle;
  EXPECT_NEAR(s.true_pose.x, radius * std::sin(angle), 0.02 * path);
  EXPECT_NEAR(s.true_pose.y, radius * (1 - std::cos(angle)), 0.02 * path);
  EXPECT_NEAR(std::remainder(shm::yaw_of(s.true_pose) - angle, 2 * M_PI), 0, 0.02 * angle);
  EXPECT_NEAR(s.odometry[0], s.true_pose.x, 0.02 * path);
  EXPECT_NEAR(s.odometry[1], s.true_pose.y, 0.02 * path);
  EXPECT_NEAR(s.velocity[0], 0.3, 0.006);
  EXPECT_NEAR(s.true_velocity[2], 0.5, 0.01);
  EXPECT_EQ(s.commanded, 1U);
  EXPECT_EQ(s.stalled, 0U);
}

TEST(Position2d, it_brakes_within_its_limits) {
  SimulationFixture f(world_of({ground(), pioneer("robot", at(0, 0, 0))}));
  auto drive = f.open(IfaceType::position2d, "robot::position2d");
  ASSERT_TRUE(drive.command_velocity(0.5, 0, 0));
  f.run(2);
  ASSERT_TRUE(drive.command_velocity(0, 0, 0));
  double before = 0.5, hardest = 0;
  for (int i = 0; i < 10; ++i) {
    f.run(0.1);
    ASSERT_TRUE(drive.read());
    const double now = drive.sample<shm::Position2dSample>().true_velocity[0];
    hardest = std::max(hardest, (before - now) / 0.1);
    before = now;
  }
  EXPECT_NEAR(before, 0, 0.005);
  EXPECT_LT(hardest, 1.1);
  EXPECT_GT(hardest, 0.8);
}

TEST(Position2d, stops_when_the_commander_goes_away) {
  SimulationFixture f(world_of({ground(), pioneer("robot", at(0, 0, 0))}));
  auto watch = f.open(IfaceType::position2d, "robot::position2d");
  {
    auto drive = f.open(IfaceType::position2d, "robot::position2d");
    ASSERT_TRUE(drive.command_velocity(0.4, 0, 0));
    f.run(1);
    ASSERT_TRUE(watch.read());
    EXPECT_NEAR(watch.sample<shm::Position2dSample>().true_velocity[0], 0.4, 0.02);
  }
  f.run(1);
  ASSERT_TRUE(watch.read());
  EXPECT_NEAR(watch.sample<shm::Position2dSample>().true_velocity[0], 0, 0.01);
  EXPECT_EQ(watch.sample<shm::Position2dSample>().commanded, 0U);
}

TEST(Position2d, says_stalled_when_a_wall_holds_it) {
  SimulationFixture f(world_of({ground(), pioneer("robot", at(0, 0, 0)), fixed("wall", BoxShape{{0.2, 4, 1}}, at(0.6, 0, 0.5))}));
  auto drive = f.open(IfaceType::position2d, "robot::position2d");
  ASSERT_TRUE(drive.command_velocity(0.3, 0, 0));
  f.run(4);
  ASSERT_TRUE(drive.read());
  const auto& s = drive.sample<shm::Position2dSample>();
  EXPECT_EQ(s.stalled, 1U);
  EXPECT_LT(s.true_pose.x, 0.5);
}

TEST(Position2d, odometry_and_motors_obey_requests) {
  SimulationFixture f(world_of({ground(), pioneer("robot", at(1, 1, 0))}));
  auto drive = f.open(IfaceType::position2d, "robot::position2d");
  Device* device = f.simulation->device("robot::position2d");
  ASSERT_NE(device, nullptr);
  ASSERT_TRUE(device->set_odometry(at(5, 6, 0, 1)));
  f.run(0.1);
  ASSERT_TRUE(drive.read());
  EXPECT_NEAR(drive.sample<shm::Position2dSample>().odometry[0], 5, 0.01);
  EXPECT_NEAR(drive.sample<shm::Position2dSample>().odometry[2], 1, 0.01);
  ASSERT_TRUE(device->set_motors(false));
  ASSERT_TRUE(drive.command_velocity(0.5, 0, 0));
  f.run(1);
  ASSERT_TRUE(drive.read());
  EXPECT_NEAR(drive.sample<shm::Position2dSample>().true_velocity[0], 0, 0.01);
  EXPECT_EQ(drive.sample<shm::Position2dSample>().motors_enabled, 0U);
}

TEST(Position2d, knows_the_plugins_of_gazebo_classic_and_gz) {
  for (const auto& [file, name] : {std::pair{"libgazebo_ros_diff_drive.so", "position2d"},
                                   {"ignition-gazebo-diff-drive-system", "ignition::gazebo::systems::DiffDrive"},
                                   {"gz-sim-diff-drive-system", "gz::sim::systems::DiffDrive"}}) {
    ModelDef robot = pioneer("robot", at(0, 0, 0));
    robot.plugins[0].filename = file;
    robot.plugins[0].name = name;
    parameter(robot, "left_joint").name = "leftJoint";
    parameter(robot, "right_joint").name = "rightJoint";
    parameter(robot, "wheel_separation").name = "wheelSeparation";
    parameter(robot, "wheel_diameter").name = "wheelDiameter";
    SimulationFixture f(world_of({ground(), robot}));
    auto drive = f.open(IfaceType::position2d, "robot::position2d");
    EXPECT_NEAR(drive.info<shm::Position2dInfo>().wheel_separation, 0.33, 1e-9) << file;
    EXPECT_NEAR(drive.info<shm::Position2dInfo>().wheel_radius, 0.0825, 1e-9) << file;
  }
}

TEST(Position2d, a_drive_without_its_joints_is_one_line_and_the_rest_runs) {
  ModelDef robot = pioneer("robot", at(0, 0, 0));
  parameter(robot, "left_joint").text = "nothing";
  SimulationFixture f(world_of({ground(), robot}));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_NE(f.dropped[0].find("nothing"), std::string::npos);
  EXPECT_EQ(f.simulation->device("robot::position2d"), nullptr);
  f.open(IfaceType::laser, "robot::laser");
}

// Files for several simulators name a drive for each; both would turn the wheels.
TEST(Position2d, a_second_drive_of_the_same_joints_is_one_line_and_no_iface) {
  ModelDef robot = pioneer("robot", at(0, 0, 0));
  robot.plugins.push_back(robot.plugins[0]);
  robot.plugins[1].filename = "libgazebo_ros_diff_drive.so";
  robot.plugins[1].name = "other_drive";
  SimulationFixture f(world_of({ground(), robot}));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_NE(f.dropped[0].find("plugin other_drive: joint \"left_wheel_hinge\" is driven by"), std::string::npos) << f.dropped[0];
  f.open(IfaceType::position2d, "robot::position2d");
  EXPECT_EQ(f.simulation->device("robot::other_drive"), nullptr);
}

TEST(Position2d, a_drive_of_joints_that_cannot_be_its_wheels_is_one_line_and_no_iface) {
  const auto line = [](const ModelDef& robot) {
    SimulationFixture f(world_of({ground(), robot}));
    EXPECT_EQ(f.simulation->device("robot::position2d"), nullptr);
    return f.dropped.size() == 1 ? f.dropped[0].substr(f.dropped[0].find(": plugin")) : std::to_string(f.dropped.size()) + " lines";
  };
  const ModelDef good = pioneer("robot", at(0, 0, 0));
  ModelDef robot = good;
  parameter(robot, "left_joint").text = parameter(robot, "right_joint").text;
  EXPECT_EQ(line(robot), ": plugin " + robot.plugins[0].name + ": joint \"right_wheel_hinge\" is named twice; the plugin is left out");
  robot = good;
  for (JointDef& joint : robot.joints) {
    if (joint.name == "left_wheel_hinge") joint.kind = JointDef::Kind::ball, joint.axes.clear();
  }
  EXPECT_EQ(line(robot), ": plugin " + robot.plugins[0].name + ": joint \"left_wheel_hinge\" turns about no axis; the plugin is left out");
  robot = good;
  robot.is_static = true;
  EXPECT_EQ(line(robot), ": plugin " + robot.plugins[0].name + ": the model is static and cannot move; the plugin is left out");
}

TEST(Laser, sees_walls_where_they_are_and_marks_what_is_too_near_or_nowhere) {
  ModelDef robot = pioneer("robot", at(0, 0, 0));
  std::get<RayDef>(robot.links[0].sensors[0].data).range_min = 0.5;
  SimulationFixture f(world_of(
      {ground(), robot, fixed("wall", BoxShape{{0.2, 2, 1}}, at(3.1, 0, 0.5)), fixed("post", CylinderShape{0.1, 1}, at(0.05, 0.5, 0.5))}));
  auto laser = f.open(IfaceType::laser, "robot::laser");
  f.run(0.5);
  ASSERT_TRUE(laser.read());
  const auto scan = laser.laser_scan();
  ASSERT_EQ(scan.ranges.size(), 181U);
  EXPECT_EQ(scan.sample->stamp.sim_time_ns, 500000000);
  EXPECT_NEAR(scan.ranges[90], 3 - scan.sample->pose.x, 0.001);
  EXPECT_TRUE(std::isinf(scan.ranges[0]) && scan.ranges[0] > 0);
  EXPECT_TRUE(std::isinf(scan.ranges[180]) && scan.ranges[180] < 0) << "the post is nearer than the minimum";
}

TEST(Laser, sees_moving_bodies_where_they_are_at_the_time_of_the_sample) {
  ModelDef ball = body("ball", SphereShape{0.2}, at(4, 0, 0.31));
  ball.links[0].gravity = false;
  SimulationFixture f(world_of({ground(), pioneer("robot", at(0, 0, 0)), ball}));
  auto laser = f.open(IfaceType::laser, "robot::laser");
  ASSERT_TRUE(f.simulation->physics().set_model_twist(2, {{-0.5, 0, 0}, {0, 0, 0}}));
  for (int i = 1; i <= 20; ++i) {
    f.run(0.1);
    ASSERT_TRUE(laser.read());
    const double ball_x = f.simulation->physics().model_pose(2).translation().x();
    ASSERT_NEAR(laser.laser_scan().ranges[90], ball_x - 0.2 - laser.laser_scan().sample->pose.x, 0.001);
  }
}

TEST(Laser, works_only_while_somebody_wants_it) {
  SimulationFixture f(world_of({ground(), pioneer("robot", at(0, 0, 0))}));
  auto laser = shm::Iface::open(own_server_id(), IfaceType::laser, "robot::laser");
  ASSERT_TRUE(laser);
  f.run(1);
  EXPECT_EQ(laser->sequence(), 0U);
  ASSERT_TRUE(laser->subscribe());
  f.run(1);
  EXPECT_EQ(laser->sequence(), 10U);
}

TEST(Laser, noise_is_the_same_for_the_same_seed_and_after_a_reset) {
  ModelDef robot = pioneer("robot", at(0, 0, 0));
  auto& ray = std::get<RayDef>(robot.links[0].sensors[0].data);
  ray.noise.kind = NoiseDef::Kind::gaussian;
  ray.noise.stddev = 0.01;
  const auto world = world_of({ground(), robot, fixed("wall", BoxShape{{0.2, 20, 1}}, at(3.1, 0, 0.5))});
  const auto scan_of = [](SimulationFixture& f, shm::Iface& laser) {
    f.run(1);
    EXPECT_TRUE(laser.read());
    const auto ranges = laser.laser_scan().ranges;
    return std::vector<float>(ranges.begin(), ranges.end());
  };
  std::vector<float> first, again, other;
  {
    SimulationFixture f(world, 5);
    auto laser = f.open(IfaceType::laser, "robot::laser");
    first = scan_of(f, laser);
    std::vector<std::string> notes;
    ASSERT_TRUE(f.simulation->reset(notes));
    again = scan_of(f, laser);
  }
  {
    SimulationFixture f(world, 6);
    auto laser = f.open(IfaceType::laser, "robot::laser");
    other = scan_of(f, laser);
  }
  EXPECT_EQ(first, again);
  EXPECT_NE(first, other);
}

SensorDef sensor(const std::string& name, SensorKind kind, const Eigen::Isometry3d& pose) {
  SensorDef result;
  result.name = name;
  result.kind = kind;
  result.pose = pose;
  result.update_rate = 100;
  return result;
}

TEST(Sonar, a_ring_measures_the_nearest_thing_in_each_cone) {
  ModelDef robot = pioneer("robot", at(0, 0, 0));
  for (int i = 0; i < 2; ++i) {
    SensorDef sonar = sensor("sonar" + std::to_string(i), SensorKind::sonar, at(0.1, 0, 0.04, i * std::numbers::pi / 2));
    sonar.data = SonarDef{0.1, 5, 5 * std::tan(0.13)};
    robot.links[0].sensors.push_back(sonar);
  }
  SimulationFixture f(world_of({ground(), robot, fixed("post", CylinderShape{0.1, 2}, at(3, 0.25, 1))}));
  auto ring = f.open(IfaceType::sonar, "robot::sonar");
  EXPECT_EQ(ring.sonar_poses().size(), 2U);
  f.run(0.1);
  ASSERT_TRUE(ring.read());
  EXPECT_NEAR(ring.sonar_scan().ranges[0], 2.86, 0.02) << "off the axis, but in the cone";
  EXPECT_TRUE(std::isinf(ring.sonar_scan().ranges[1])) << "nothing to the left";
}

TEST(Imu, feels_gravity_at_rest_nothing_in_free_fall_and_turns_with_the_body) {
  ModelDef box = body("box", BoxShape{{0.4, 0.4, 0.4}}, at(0, 0, 0.2));
  SensorDef imu = sensor("imu", SensorKind::imu, Eigen::Isometry3d::Identity());
  imu.data = ImuDef{};
  box.links[0].sensors.push_back(imu);
  ModelDef falling = box;
  falling.name = "falling";
  falling.pose = at(5, 0, 100, 0.7);
  SimulationFixture f(world_of({ground(), box, falling}));
  auto rest = f.open(IfaceType::imu, "box::imu"), fall = f.open(IfaceType::imu, "falling::imu");
  ASSERT_TRUE(f.simulation->physics().set_model_twist(2, {{0, 0, 0}, {0, 0, 2}}));
  f.run(0.5);
  ASSERT_TRUE(rest.read() && fall.read());
  EXPECT_NEAR(rest.sample<shm::ImuSample>().acceleration[2], 9.8, 0.05);
  EXPECT_NEAR(fall.sample<shm::ImuSample>().acceleration[2], 0, 0.05);
  EXPECT_NEAR(fall.sample<shm::ImuSample>().angular_velocity[2], 2, 0.01);
  const auto& q = fall.sample<shm::ImuSample>().orientation;
  EXPECT_NEAR(2 * std::atan2(q[3], q[0]), 0.7 + 2 * 0.5, 0.02);
}

TEST(Imu, feels_nothing_in_free_fall_from_its_first_sample_on) {
  ModelDef falling = body("falling", BoxShape{{0.4, 0.4, 0.4}}, at(0, 0, 100));
  SensorDef imu = sensor("imu", SensorKind::imu, Eigen::Isometry3d::Identity());
  imu.data = ImuDef{};
  falling.links[0].sensors.push_back(imu);
  SimulationFixture f(world_of({falling}));
  f.run(0.2);
  auto late = f.open(IfaceType::imu, "falling::imu");
  f.simulation->answer_new_subscribers();
  ASSERT_TRUE(late.read());
  EXPECT_NEAR(late.sample<shm::ImuSample>().acceleration[2], 0, 0.01);
}

TEST(Gps, one_second_of_arc_north_is_where_the_ellipsoid_says) {
  SphericalDef place;
  place.latitude = 45;
  place.longitude = 7;
  place.elevation = 200;
  // Radius of curvature along the meridian at 45 degrees: 6367381.8 m.
  const auto north = geodetic_of(place, {0, 1000, 0});
  EXPECT_NEAR(north[0] - 45, 1000 / (6367381.8 + 200) * 180 / M_PI, 1e-7);
  EXPECT_NEAR(north[1], 7, 1e-9);
  EXPECT_NEAR(north[2], 200 + 0.0785, 0.001) << "the tangent leaves the ellipsoid";
  const auto here = geodetic_of(place, {0, 0, 0});
  EXPECT_NEAR(here[0], 45, 1e-10);
  EXPECT_NEAR(here[2], 200, 1e-6);
}

TEST(Gps, reports_position_and_velocity) {
  WorldDef world = world_of({ground(), pioneer("robot", at(10, 20, 0))});
  world.spherical.latitude = 35;
  world.spherical.longitude = 139;
  SensorDef gps = sensor("gps", SensorKind::gps, Eigen::Isometry3d::Identity());
  gps.data = GpsDef{};
  world.models[1].links[0].sensors.push_back(gps);
  SimulationFixture f(world);
  auto iface = f.open(IfaceType::gps, "robot::gps");
  auto drive = f.open(IfaceType::position2d, "robot::position2d");
  ASSERT_TRUE(drive.command_velocity(0.4, 0, 0));
  f.run(2);
  ASSERT_TRUE(iface.read());
  const auto& s = iface.sample<shm::GpsSample>();
  EXPECT_NEAR(s.velocity[0], 0.4, 0.01);
  EXPECT_NEAR(s.latitude, 35 + 20 / 6358000.0 * 180 / M_PI, 2e-6);
}

TEST(Bumper, reports_what_it_touches_with_force) {
  ModelDef box = body("box", BoxShape{{0.4, 0.4, 0.4}}, at(0, 0, 0.2), 10);
  SensorDef bumper = sensor("bumper", SensorKind::contact, Eigen::Isometry3d::Identity());
  bumper.data = ContactDef{{"collision"}};
  box.links[0].sensors.push_back(bumper);
  SimulationFixture f(world_of({ground(), box}));
  auto iface = f.open(IfaceType::bumper, "box::bumper");
  f.run(2);
  ASSERT_TRUE(iface.read());
  const auto view = iface.bumper();
  ASSERT_GE(view.contacts.size(), 3U);
  double up = 0;
  for (const auto& contact : view.contacts) {
    up += contact.force[2];
    EXPECT_STREQ(contact.other, "ground::link::collision");
    EXPECT_GT(contact.normal[2], 0.99);
  }
  EXPECT_NEAR(up, 98, 1) << "also while it sleeps";
}

TEST(Bumper, tells_the_forces_of_a_body_that_slept_before_anybody_asked) {
  ModelDef box = body("box", BoxShape{{0.4, 0.4, 0.4}}, at(0, 0, 0.2), 10);
  SensorDef bumper = sensor("bumper", SensorKind::contact, Eigen::Isometry3d::Identity());
  bumper.data = ContactDef{{"collision"}};
  box.links[0].sensors = {bumper, bumper};
  box.links[0].sensors[1].name = "other";
  SimulationFixture f(world_of({ground(), box}));
  f.run(2);
  const auto weight = [&](const std::string& name) {
    auto iface = f.open(IfaceType::bumper, name);
    f.run(0.1);
    if (!iface.read()) return 0.0;
    double up = 0;
    for (const auto& contact : iface.bumper().contacts) up += contact.force[2];
    return up;
  };
  ASSERT_EQ(f.simulation->physics().statistics().awake, 0U);
  EXPECT_EQ(f.simulation->physics().statistics().contacts, 4U) << "it touches the floor also while it sleeps";
  EXPECT_NEAR(weight("box::bumper"), 98, 1);
  EXPECT_NEAR(weight("box::other"), 98, 1) << "the first one's client has gone";
  std::vector<std::string> notes;
  ASSERT_TRUE(f.simulation->reset(notes));
  f.run(0.3);
  EXPECT_NEAR(weight("box::bumper"), 98, 1) << "after a reset";
}

TEST(Simulation, hash_is_equal_for_equal_runs_on_any_threads_and_after_a_reset) {
  std::vector<ModelDef> models{ground()};
  for (int i = 0; i < 9; ++i) models.push_back(pioneer("robot" + std::to_string(i), at(1.5 * (i % 3), 1.5 * (i / 3), 0, i)));
  const auto world = world_of(models, 0.002);
  const auto drive = [](SimulationFixture& f) {
    std::vector<shm::Iface> ifaces;
    for (int i = 0; i < 9; ++i) {
      ifaces.push_back(f.open(IfaceType::position2d, "robot" + std::to_string(i) + "::position2d"));
      ifaces.push_back(f.open(IfaceType::laser, "robot" + std::to_string(i) + "::laser"));
      EXPECT_TRUE(ifaces[ifaces.size() - 2].command_velocity(0.3 + 0.02 * i, 0, 0.2 - 0.05 * i));
    }
    f.run(10);
    return f.simulation->hash();
  };
  std::uint64_t one = 0, two = 0, again = 0;
  {
    SimulationFixture f(world, 1, 1);
    one = drive(f);
  }
  {
    SimulationFixture f(world, 1, 2);
    two = drive(f);
    std::vector<std::string> notes;
    ASSERT_TRUE(f.simulation->reset(notes));
    again = drive(f);
  }
  EXPECT_EQ(one, two);
  EXPECT_EQ(one, again);
}

TEST(Simulation, who_subscribes_while_time_stands_still_sees_the_present_and_disturbs_nothing) {
  const auto with_noise = [] {
    auto robot = pioneer("robot", at(0, 0, 0));
    auto& noise = std::get<RayDef>(robot.links[0].sensors[0].data).noise;
    noise.kind = NoiseDef::Kind::gaussian;
    noise.stddev = 0.02;
    return world_of({ground(), robot, fixed("wall", BoxShape{{0.2, 20, 2}}, at(3, 0, 1))});
  };
  std::vector<float> undisturbed;
  std::uint64_t hash = 0;
  for (const bool is_looked_at : {false, true}) {
    SimulationFixture f(with_noise());
    f.run(1.05);
    if (is_looked_at) {
      for (int visit = 0; visit < 3; ++visit) {
        auto laser = f.open(IfaceType::laser, "robot::laser");
        const auto before = laser.sequence();
        f.simulation->answer_new_subscribers();
        f.simulation->answer_new_subscribers();
        ASSERT_EQ(laser.sequence(), before + 1) << "one sample for a sensor that was switched on";
        ASSERT_TRUE(laser.read());
        EXPECT_EQ(laser.sample<shm::LaserSample>().stamp.sim_time_ns, f.simulation->time().count());
        EXPECT_NEAR(laser.laser_scan().ranges[90], 3 - 0.1 - 0.1, 0.2);
        auto second = f.open(IfaceType::laser, "robot::laser");
        f.simulation->answer_new_subscribers();
        EXPECT_EQ(laser.sequence(), before + 1) << "the first one must not get another";
        EXPECT_TRUE(second.read());
        laser.unsubscribe();
        second.unsubscribe();
        f.simulation->answer_new_subscribers();
      }
    }
    auto laser = f.open(IfaceType::laser, "robot::laser");
    f.run(0.5);
    ASSERT_TRUE(laser.read());
    const auto ranges = laser.laser_scan().ranges;
    if (!is_looked_at) {
      undisturbed.assign(ranges.begin(), ranges.end());
      hash = f.simulation->hash();
    } else {
      EXPECT_TRUE(std::equal(ranges.begin(), ranges.end(), undisturbed.begin(), undisturbed.end()));
      EXPECT_EQ(f.simulation->hash(), hash);
    }
  }
}

TEST(Simulation, a_reset_brings_back_what_was_deleted_and_takes_away_what_was_spawned) {
  SimulationFixture f(world_of({ground(), pioneer("robot", at(0, 0, 0))}));
  std::vector<std::string> notes;
  ASSERT_TRUE(f.simulation->spawn(pioneer("second", at(3, 0, 0)), notes));
  auto laser = f.open(IfaceType::laser, "second::laser");
  auto first = f.open(IfaceType::laser, "robot::laser");
  f.run(0.2);
  EXPECT_GT(laser.sequence(), 0U);
  f.simulation->remove(*f.simulation->physics().find("robot"));
  EXPECT_EQ(first.status(), shm::Status::closed) << "deleted while somebody listens";
  f.run(0.2);
  ASSERT_TRUE(f.simulation->reset(notes));
  EXPECT_EQ(laser.status(), shm::Status::closed);
  ASSERT_TRUE(first.reopen());
  f.run(0.2);
  EXPECT_GT(first.sequence(), 0U);
}

TEST(Simulation, a_name_that_is_taken_is_refused_and_changes_nothing) {
  SimulationFixture f(world_of({ground(), pioneer("robot", at(0, 0, 0))}));
  const auto before = f.simulation->hash();
  const auto devices = f.simulation->devices().size();
  std::vector<std::string> notes;
  EXPECT_FALSE(f.simulation->spawn(pioneer("robot", at(3, 0, 0)), notes));
  EXPECT_EQ(f.simulation->devices().size(), devices);
  EXPECT_EQ(f.simulation->hash(), before);
}

}  // namespace
}  // namespace sim

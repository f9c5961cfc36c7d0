// The rolling step: which robots roll, when they begin and end, and that they move as ODE would move them. real_robots_test compares
// robots that people use.
#include <gtest/gtest.h>
#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <map>

#include "physics/rolling_motion.h"
#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;

constexpr double wheel_radius = 0.1, track = 0.4;

// Instead of the fixed ball, one in a ball joint.
std::string with_ball_joint(std::string text) {
  const auto begin = text.find("<collision name='ball'>"), end = text.find("</collision>", begin) + 12;
  std::string ball = text.substr(begin, end - begin);
  text.erase(begin, end - begin);
  ball.replace(ball.find("<pose>"), ball.find("</pose>") + 7 - ball.find("<pose>"), "");
  const std::string link =
      "<link name='ball'><pose>-0.2 0 0.03 0 0 0</pose><inertial><mass>0.3</mass><inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz>"
      "</inertia></inertial>" +
      ball + "</link><joint name='ball_joint' type='ball'><parent>base</parent><child>ball</child></joint></model>";
  return text.replace(text.rfind("</model>"), 8, link);
}

// 6 kg on two wheels and a ball, which looks along x.
std::string robot_text(const std::string& name, double x, double y, double ball_friction = 0) {
  std::string text = fmt::format(
      "<model name='{0}'><pose>{1} {2} 0 0 0 0</pose><link name='base'><inertial><pose>-0.05 0 0.12 0 0 0</pose><mass>5</mass><inertia>"
      "<ixx>0.05</ixx><iyy>0.08</iyy><izz>0.1</izz></inertia></inertial><collision name='body'><pose>-0.05 0 0.12 0 0 0</pose><geometry>"
      "<box><size>0.4 0.3 0.1</size></box></geometry></collision><collision name='ball'><pose>-0.2 0 0.03 0 0 0</pose><geometry><sphere>"
      "<radius>0.03</radius></sphere></geometry><surface><friction><ode><mu>{3}</mu><mu2>{3}</mu2></ode></friction></surface></collision>"
      "</link>",
      name, x, y, ball_friction);
  for (const auto& [side, place] : {std::pair{"left", track / 2}, {"right", -track / 2}}) {
    text += fmt::format(
        "<link name='{0}'><pose>0 {1} {2} -1.570796326794897 0 0</pose><inertial><mass>0.5</mass><inertia><ixx>0.001</ixx><iyy>0.001"
        "</iyy><izz>0.002</izz></inertia></inertial><collision name='c'><geometry><cylinder><radius>{2}</radius><length>0.04</length>"
        "</cylinder></geometry></collision></link><joint name='{0}_joint' type='continuous'><parent>base</parent><child>{0}</child><axis>"
        "<xyz>0 0 1</xyz></axis></joint>",
        side, place, wheel_radius);
  }
  return text + "</model>";
}

const std::string floor_text =
    "<model name='floor'><static>true</static><link name='l'><collision name='c'><geometry><plane/></geometry></collision></link></model>";

std::string step_text(double step) { return fmt::format("<physics type='ode'><max_step_size>{}</max_step_size></physics>", step); }

std::string wall_text(const std::string& name, double x, double y) {
  return fmt::format(
      "<model name='{}'><static>true</static><pose>{} {} 0.5 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>0.1 1 1"
      "</size></box></geometry></collision></link></model>",
      name, x, y);
}

struct Rollers : PhysicsFixture {
  explicit Rollers(const std::string& models, int threads = 1, bool rolling = true, double step = 0.005)
      : PhysicsFixture(world_of_text(step_text(step) + floor_text + models), threads) {
    physics.let_roll(rolling);
    if (physics.find("a")) drive("a", 0, 0);
    run(1);
  }
  // Forward [m/s] and yaw [rad/s].
  void drive(const std::string& name, double forward, double yaw, double effort = 5) {
    physics.set_motor(joint(name, "left_joint"), 0, (forward - yaw * track / 2) / wheel_radius, effort);
    physics.set_motor(joint(name, "right_joint"), 0, (forward + yaw * track / 2) / wheel_radius, effort);
  }
  // In small steps of the speed, so that no wheel slips.
  void speed_up(const std::string& name, double forward, double yaw) {
    const double forward_before = driven[name].first, yaw_before = driven[name].second;
    for (int i = 1; i <= 50; ++i) {
      drive(name, forward_before + (forward - forward_before) * i / 50, yaw_before + (yaw - yaw_before) * i / 50);
      run(0.02);
    }
    driven[name] = {forward, yaw};
  }
  std::map<std::string, std::pair<double, double>> driven;
  bool rolls() const { return physics.statistics().rolling > 0; }
};

TEST(RollingStep, begins_after_half_a_second_alone_on_level_ground) {
  Rollers f(robot_text("a", 0, 0));
  EXPECT_TRUE(f.rolls());
  EXPECT_EQ(f.physics.contacts(f.id("a")).size(), 3U) << "as ODE left them";
}

TEST(RollingStep, is_off_unless_it_is_asked_for) {
  Rollers f(robot_text("a", 0, 0), 1, false);
  EXPECT_FALSE(f.rolls());
}

class RollingSteps : public ::testing::TestWithParam<double> {};

TEST_P(RollingSteps, move_a_robot_as_ode_does) {
  Rollers ode(robot_text("a", 0, 0, 0.3), 1, false, GetParam()), rolling(robot_text("a", 0, 0, 0.3), 1, true, GetParam());
  for (Rollers* f : {&ode, &rolling}) {
    f->speed_up("a", 0.5, 0);
    f->run(2);
    f->speed_up("a", 0.5, 1);
    f->run(2);
    f->speed_up("a", 0, -1);
    f->run(2);
  }
  EXPECT_TRUE(rolling.rolls());
  EXPECT_LT((ode.position("a") - rolling.position("a")).norm(), 1e-3);
  const LinkId base = ode.link("a::base");
  EXPECT_LT(Eigen::AngleAxisd(ode.physics.link_pose(base).linear().transpose() * rolling.physics.link_pose(base).linear()).angle(), 1e-3);
  EXPECT_NEAR(ode.physics.joint_state(ode.joint("a", "left_joint")).velocity,
              rolling.physics.joint_state(rolling.joint("a", "left_joint")).velocity, 1e-6);
  EXPECT_LT((ode.physics.link_twist(base).linear - rolling.physics.link_twist(base).linear).norm(), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Lengths, RollingSteps, ::testing::Values(0.001, 0.002, 0.005, 0.01),
                         [](const auto& parameter) { return fmt::format("{:.0f}_ms", parameter.param * 1e3); });

TEST(RollingStep, is_not_made_of_steps_longer_than_0_01_s) {
  Rollers f(robot_text("a", 0, 0), 1, true, 0.02);
  EXPECT_FALSE(f.rolls());
}

TEST(RollingStep, moves_a_robot_on_a_ball_in_a_joint_as_ode_does) {
  for (const double friction : {0.0, 0.8}) {
    const std::string robot = with_ball_joint(robot_text("a", 0, 0, friction));
    Rollers ode(robot, 1, false), rolling(robot);
    for (Rollers* f : {&ode, &rolling}) {
      f->speed_up("a", 0.5, 0);
      f->run(2);
      f->speed_up("a", 0.5, 1);
      f->run(2);
    }
    EXPECT_TRUE(rolling.rolls()) << friction;
    EXPECT_LT((ode.position("a") - rolling.position("a")).norm(), 1e-3) << friction;
    const LinkId base = ode.link("a::base"), ball = ode.link("a::ball");
    EXPECT_LT(Eigen::AngleAxisd(ode.physics.link_pose(base).linear().transpose() * rolling.physics.link_pose(base).linear()).angle(), 1e-3);
    const Eigen::Vector3d turns = ode.physics.link_twist(ball).angular, turned = rolling.physics.link_twist(ball).angular;
    EXPECT_LT((turns - turned).norm(), 0.2) << friction << ": " << turns.transpose() << " and " << turned.transpose();
    EXPECT_LT((ode.physics.link_pose(ball).translation() - rolling.physics.link_pose(ball).translation()).norm(), 1e-3);
  }
}

TEST(RollingStep, gives_weak_motors_the_acceleration_that_ode_gives_them) {
  Rollers ode(robot_text("a", 0, 0, 0.3), 1, false), rolling(robot_text("a", 0, 0, 0.3));
  for (Rollers* f : {&ode, &rolling}) {
    f->drive("a", 1, 0.5, 0.25);
    f->run(1.5);
  }
  EXPECT_TRUE(rolling.rolls());
  const LinkId base = ode.link("a::base");
  const Eigen::Vector3d speed = ode.physics.link_twist(base).linear;
  EXPECT_GT(speed.norm(), 0.1);
  EXPECT_LT((speed - rolling.physics.link_twist(base).linear).norm(), 0.1 * speed.norm());
}

TEST(RollingStep, lets_a_robot_with_damped_axles_coast_as_ode_does) {
  std::string robot = robot_text("a", 0, 0);
  const std::string axis = "<xyz>0 0 1</xyz>";
  for (auto at = robot.find(axis); at != std::string::npos; at = robot.find(axis, at + 20))
    robot.insert(at + axis.size(), "<dynamics><damping>0.02</damping></dynamics>");
  Rollers ode(robot, 1, false), rolling(robot);
  for (Rollers* f : {&ode, &rolling}) {
    f->speed_up("a", 0.5, 0.5);
    f->run(1);
    f->drive("a", 0, 0, 0);  // the motors are off
    f->run(1);
  }
  EXPECT_TRUE(rolling.rolls());
  const LinkId base = ode.link("a::base");
  const Eigen::Vector3d speed = ode.physics.link_twist(base).linear;
  EXPECT_GT(speed.norm(), 0.1);
  EXPECT_LT(speed.norm(), 0.45) << "the axles brake it";
  EXPECT_LT((speed - rolling.physics.link_twist(base).linear).norm(), 0.02 * speed.norm());
}

TEST(RollingStep, ends_before_a_wall_and_ode_has_the_collision) {
  Rollers f(robot_text("a", 0, 0) + wall_text("wall", 2, 0));
  EXPECT_TRUE(f.rolls());
  f.speed_up("a", 0.5, 0);
  EXPECT_TRUE(f.rolls());
  f.run(4);
  EXPECT_FALSE(f.rolls());
  EXPECT_LT(f.position("a").x(), 1.85);
}

TEST(RollingStep, ends_when_another_body_comes_near) {
  Rollers f(robot_text("a", 0, 0) + robot_text("b", 3, 0.6));
  EXPECT_EQ(f.physics.statistics().rolling, 2U);
  f.drive("b", 0, 0);
  f.speed_up("a", 0.5, 0);
  EXPECT_EQ(f.physics.statistics().rolling, 2U);
  f.run(5.2);
  EXPECT_EQ(f.physics.statistics().rolling, 1U) << "they are side by side at " << f.position("a").x() << "; the other one sleeps";
  f.run(4);
  EXPECT_EQ(f.physics.statistics().rolling, 2U) << "and have parted";
}

TEST(RollingStep, goes_on_beside_a_body_that_moves_and_is_not_near) {
  Rollers f(
      robot_text("a", 0, 0) +
      "<model name='ball'><pose>0.25 0.3 0.05 0 0 0</pose><link "
      "name='l'><inertial><mass>1</mass><inertia><ixx>0.001</ixx><iyy>0.001</iyy><izz>0.001</izz></inertia></inertial><collision name='c'>"
      "<geometry><sphere><radius>0.05</radius></sphere></geometry></collision></link></model>");
  f.run(0.5);
  ASSERT_TRUE(f.physics.set_model_twist(f.id("ball"), {{0, 0, 0}, {0, 0, 5}}));
  f.drive("a", 0, 0.02);
  for (int i = 0; i < 200; ++i) {
    f.run(0.005);
    ASSERT_TRUE(f.rolls()) << i;
  }
  EXPECT_EQ(f.physics.statistics().awake, 4U) << "the ball turns";
  const Eigen::Matrix3d turn = f.physics.link_pose(f.link("a::base")).linear();
  EXPECT_NEAR(std::atan2(turn(1, 0), turn(0, 0)), 0.02, 1e-4) << "one step at a time";
}

TEST(RollingStep, ends_when_somebody_pushes_places_or_throws_the_robot) {
  Rollers f(robot_text("a", 0, 0));
  ASSERT_TRUE(f.physics.add_wrench(f.link("a::base"), {0, 30, 0}, {0, 0, 0}));
  EXPECT_FALSE(f.rolls());
  f.run(1);
  EXPECT_TRUE(f.rolls());
  ASSERT_TRUE(f.physics.set_model_pose(f.id("a"), Eigen::Isometry3d(Eigen::Translation3d(1, 2, 0.3))));
  EXPECT_FALSE(f.rolls());
  f.run(0.3);
  EXPECT_LT(f.position("a").z(), 0.2) << "it falls";
  f.run(1.5);
  EXPECT_TRUE(f.rolls());
  ASSERT_TRUE(f.physics.set_model_twist(f.id("a"), {{0, 0.5, 2}, {0, 0, 0}}));
  EXPECT_FALSE(f.rolls());
  f.run(0.1);
  EXPECT_GT(f.position("a").z(), 0.05) << "it jumps";
}

TEST(RollingStep, leaves_wheels_that_slip_to_ode) {
  Rollers ode(robot_text("a", 0, 0), 1, false), f(robot_text("a", 0, 0));
  EXPECT_TRUE(f.rolls());
  for (Rollers* each : {&ode, &f}) each->drive("a", 3, 0, 50), each->run(0.2);
  EXPECT_FALSE(f.rolls());
  EXPECT_NEAR(f.position("a").x(), ode.position("a").x(), 1e-3);
}

TEST(RollingStep, ends_at_the_edge_of_a_box_that_carries_the_robot) {
  Rollers f(
      "<model name='table'><static>true</static><pose>0 0 0.25 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>3 2 0.5"
      "</size></box></geometry></collision></link></model>");
  auto loaded = world_of_text(robot_text("a", 0, 0));
  loaded.models[0].pose.translation().z() = 0.5;
  ASSERT_TRUE(f.physics.spawn(std::make_shared<const ModelDef>(loaded.models[0]), f.notes));
  f.drive("a", 0, 0);
  f.run(1);
  EXPECT_TRUE(f.rolls());
  f.speed_up("a", 0.5, 0);
  f.run(4);
  EXPECT_FALSE(f.rolls());
  EXPECT_LT(f.position("a").z(), 0.45) << "it has fallen from the table";
}

TEST(RollingStep, ends_when_the_ground_is_taken_away) {
  Rollers f(robot_text("a", 0, 0));
  EXPECT_TRUE(f.rolls());
  f.physics.remove(f.id("floor"));
  f.run(0.5);
  EXPECT_FALSE(f.rolls());
  EXPECT_LT(f.position("a").z(), -0.5);
}

TEST(RollingStep, sleeps_and_wakes_by_a_motor) {
  Rollers f(robot_text("a", 0, 0));
  f.run(1);
  EXPECT_EQ(f.physics.statistics().awake, 0U);
  f.speed_up("a", 0.5, 0);
  EXPECT_EQ(f.physics.statistics().awake, 3U);
  EXPECT_TRUE(f.rolls());
  EXPECT_GT(f.position("a").x(), 0.2);
}

TEST(RollingStep, does_not_take_robots_on_a_slope) {
  std::string text = robot_text("a", 0, 0);
  Rollers f("");
  auto world = world_of_text("<gravity>-1 0 -9.7</gravity>" + floor_text + text);
  PhysicsFixture tilted(std::move(world));
  tilted.physics.let_roll(true);
  tilted.run(1);
  EXPECT_EQ(tilted.physics.statistics().rolling, 0U);
}

TEST(RollingStep, has_equal_hashes_on_one_and_two_threads_and_after_a_reset) {
  std::string models;
  for (int i = 0; i < 12; ++i) models += robot_text(i == 0 ? "a" : fmt::format("r{}", i), 1.5 * (i % 4), 1.5 * (i / 4));
  const auto drive = [](Rollers& f) {
    for (int i = 0; i < 12; ++i) f.drive(i == 0 ? "a" : fmt::format("r{}", i), 0.1 + 0.03 * i, 0.1 * (i % 5) - 0.2, 0.4);
    f.run(4);
    return f.hash();
  };
  Rollers one(models, 1), two(models, 2);
  const std::uint64_t first = drive(one);
  EXPECT_GT(one.physics.statistics().rolling, 0U);
  EXPECT_EQ(drive(two), first);
  one.physics.reset();
  one.drive("a", 0, 0);
  one.run(1);
  EXPECT_EQ(drive(one), first);
}

TEST(RollingMotion, does_not_step_when_a_wheel_would_slip_or_a_contact_would_lift_off) {
  const RollingMass mass{6, 0.2, -0.05, 0, 0.1};
  const std::array<RollingWheel, 2> wheels{{{0.2, 0.1, 0.002, 1}, {-0.2, 0.1, 0.002, 1}}};
  auto motion = RollingMotion::of(mass, wheels, {{-0.2, 0, 0}}, 9.8);
  ASSERT_TRUE(motion);
  EXPECT_TRUE(motion->step({{{0.1, 5}, {0.1, 5}}}, 0.005));
  EXPECT_NEAR(motion->speeds().forward, 0.01, 1e-12);
  EXPECT_FALSE(motion->step({{{10, 50}, {10, 50}}}, 0.005)) << "slips";
  EXPECT_NEAR(motion->speeds().forward, 0.01, 1e-12) << "nothing has changed";
  RollingMass tall = mass;
  tall.height = 2;
  auto nods = RollingMotion::of(tall, wheels, {{-0.2, 0, 0}}, 9.8);
  ASSERT_TRUE(nods);
  EXPECT_FALSE(nods->step({{{-0.2, 5}, {-0.2, 5}}}, 0.005)) << "lifts its ball";
  EXPECT_FALSE(RollingMotion::of(mass, wheels, {{0.2, 0, 0}}, 9.8)) << "stands in front of its centre of mass";
}

}  // namespace
}  // namespace sim

// Answers and motions of a JARA manipulator, without the wire.
#include "arms/manipulator.h"

#include <gtest/gtest.h>
#include <shm/layout.h>

#include <cmath>
#include <cstring>

namespace manipulators {
namespace {

using arms::Answer;
using arms::FingerCommand;
using arms::Manipulator;
using arms::Plan;
using arms::Planner;
using arms::Reply;
using Positions = std::vector<double>;
using Pose = Eigen::Isometry3d;

shm::Joint joint(const char* name, std::uint32_t parent, double z, int axis, double low, double high) {
  shm::Joint made{};
  std::strcpy(made.name, name);
  made.kind = RTMSIM_JOINT_TURNS, made.parent = parent;
  made.lower = low, made.upper = high, made.max_velocity = M_PI;
  made.axis[axis] = 1;
  made.pose = shm::identity_pose;
  made.pose.z = z;
  return made;
}

std::vector<shm::Joint> six() {
  return {joint("waist", 0, 0.1, 2, -2.9, 2.9), joint("shoulder", 1, 0.15, 1, -1.9, 1.9), joint("elbow", 2, 0.35, 1, -0.3, 2.6),
          joint("roll", 3, 0.15, 2, -3.1, 3.1), joint("pitch", 4, 0.2, 1, -2.1, 2.1),     joint("twist", 5, 0.08, 2, -4.7, 4.7)};
}

struct Arm {
  Arm() {
    arm.begin(six(), true, 0.5);
    feed();
  }
  void on() { ASSERT_TRUE(arm.set_servo(true).is_ok()); }
  // The arm follows its targets exactly, and the fingers take no time.
  void feed() { arm.feed({at, 0, are_fingers_still, {}}); }
  void step(double dt = 0.001) {
    if (const auto target = arm.advance(dt)) at = target->positions;
    if (const auto command = arm.take_finger_command()) fingers.push_back(*command);
    feed();
  }
  void steps(int count) {
    for (int i = 0; i < count; ++i) step();
  }
  bool is_moving() const { return (arm.state() & Manipulator::is_moving) != 0; }
  // Seconds until it stands, at most 100.
  double run() {
    int count = 0;
    for (; is_moving() && count < 100000; ++count) step();
    return count * 0.001;
  }
  Reply joints(const Positions& goal, bool is_relative = false) {
    return arm.move([&](const Planner& planner, const Positions& from) { return planner.to_joints(from, goal, is_relative); });
  }
  Reply pose(const Pose& goal, bool is_relative = false) {
    return arm.move([&](const Planner& planner, const Positions& from) { return planner.to_pose(from, goal, is_relative); });
  }
  Reply line(const Pose& goal, bool is_relative = false) {
    return arm.move([&](const Planner& planner, const Positions& from) { return planner.along_line(from, goal, is_relative); });
  }
  Reply arc(const Pose& via, const Pose& goal, bool is_relative = false) {
    return arm.move([&](const Planner& planner, const Positions& from) { return planner.along_arc(from, via, goal, is_relative); });
  }
  Manipulator arm;
  Positions at{0, 0, 1, 0, 1, 0};
  bool are_fingers_still = true;
  std::vector<FingerCommand> fingers;
};

Pose moved(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  return pose;
}

TEST(Manipulator, moves_joints_in_the_time_that_speed_and_acceleration_take) {
  Arm f;
  EXPECT_EQ(f.joints(f.at).answer, Answer::servo_off);
  f.on();
  auto goal = f.at;
  goal[0] += M_PI / 2, goal[1] += 0.3;
  ASSERT_TRUE(f.joints(goal).is_ok());
  EXPECT_TRUE(f.is_moving()) << "before any time passes";
  EXPECT_NEAR(f.run(), 1.5, 0.003) << "90 degrees at 50 % of 180 degrees a second, 0.5 s to full speed";
  EXPECT_EQ(f.at, goal);
}

TEST(Manipulator, moves_all_joints_alike_so_that_they_arrive_together) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({1, -0.5, 0.2, 0, 0, 0.1}, true).is_ok());
  while (f.is_moving()) {
    f.step();
    ASSERT_NEAR(f.at[1], -0.5 * f.at[0], 1e-9);
    ASSERT_NEAR(f.at[2] - 1, 0.2 * f.at[0], 1e-9);
  }
}

TEST(Manipulator, rejects_wrong_values_and_nothing_moves) {
  Arm f;
  f.on();
  const auto before = f.at;
  const double nan = std::nan("");
  EXPECT_EQ(f.joints({1, 2}).answer, Answer::wrong_value);
  EXPECT_EQ(f.joints({1, 2}).comment, "expected 6 joints, got 2");
  EXPECT_EQ(f.joints({9, 0, 0, 0, 0, 0}).comment, "joint 1: expected -2.9 to 2.9 [rad or m], got 9");
  EXPECT_EQ(f.joints({nan, 0, 0, 0, 0, 0}).comment, "joint 1: expected -2.9 to 2.9 [rad or m], got nan");
  Pose bad = f.arm.pose();
  bad.linear().setConstant(7);
  EXPECT_EQ(f.line(bad).answer, Answer::wrong_value);
  EXPECT_EQ(f.pose(bad).comment, "the rotation part of the matrix is not a rotation");
  bad.linear() = -Eigen::Matrix3d::Identity();
  EXPECT_EQ(f.pose(bad).answer, Answer::wrong_value) << "a mirror";
  Pose far = f.arm.pose();
  far.translation().x() = 5;
  EXPECT_EQ(f.line(far).answer, Answer::wrong_value);
  EXPECT_EQ(f.pose(far).comment, "the arm cannot reach the pose within its limits");
  far.translation().x() = nan;
  EXPECT_EQ(f.pose(far).answer, Answer::wrong_value);
  EXPECT_EQ(f.arc(moved(0.1, 0, 0), moved(0.2, 0, 0), true).comment, "the start, the via point and the goal are on one line");
  EXPECT_EQ(f.arm.set_joint_speed(101).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.set_joint_time(nan).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.set_joint_time(-1).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.set_max_joint_speeds({1, 1, 1, 1, 1, 99}).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.set_max_joint_speeds({1}).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.set_max_cartesian_speed(0, 1).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.set_soft_limits({{-9, 9}}).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.set_home({9, 0, 0, 0, 0, 0}).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.set_tool(bad).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.move_fingers({FingerCommand::Kind::move, 1.01}).answer, Answer::wrong_value);
  EXPECT_EQ(f.arm.follow({1}).answer, Answer::wrong_value);
  EXPECT_EQ(f.run(), 0);
  EXPECT_EQ(f.at, before);
}

TEST(Manipulator, does_not_move_at_a_speed_of_zero) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.arm.set_joint_speed(0).is_ok());
  ASSERT_TRUE(f.arm.set_cartesian_speed(0).is_ok());
  EXPECT_EQ(f.joints({1, 0, 1, 0, 1, 0}).comment, "the joint speed is 0 %; setSpeedJoint sets it");
  EXPECT_EQ(f.line(moved(0, 0.01, 0), true).answer, Answer::wrong_value);
}

TEST(Manipulator, moves_the_control_point_along_a_line) {
  Arm f;
  f.on();
  const Pose start = f.arm.pose(), offset = moved(0.02, 0.1, -0.05);
  ASSERT_TRUE(f.line(offset, true).is_ok());
  const Eigen::Vector3d line = offset.translation().normalized();
  while (f.is_moving()) {
    f.step();
    const Eigen::Vector3d way = f.arm.pose().translation() - start.translation();
    ASSERT_LT(way.cross(line).norm(), 1e-5);
    ASSERT_LT(arms::difference(f.arm.pose(), start).tail<3>().norm(), 1e-4);
  }
  EXPECT_LT((f.arm.pose().translation() - start.translation() - offset.translation()).norm(), 1e-6);
}

TEST(Manipulator, takes_the_time_of_the_cartesian_speed_along_a_line) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.arm.set_max_cartesian_speed(1, 3).is_ok());
  ASSERT_TRUE(f.arm.set_cartesian_speed(100).is_ok());
  ASSERT_TRUE(f.line(moved(0, 0, -0.1), true).is_ok());
  EXPECT_NEAR(f.run(), 0.447, 0.003) << "0.1 m at 1 m/s, 2 m/s^2";
}

TEST(Manipulator, moves_the_control_point_around_an_arc_through_the_via_point) {
  Arm f;
  f.on();
  const Eigen::Vector3d from = f.arm.pose().translation(), center = from + Eigen::Vector3d(0, -0.05, 0);
  ASSERT_TRUE(f.arc(moved(0, -0.05, 0.05), moved(0, -0.1, 0), true).is_ok());
  double highest = 0;
  while (f.is_moving()) {
    f.step();
    ASSERT_NEAR((f.arm.pose().translation() - center).norm(), 0.05, 1e-5);
    highest = std::max(highest, f.arm.pose().translation().z() - from.z());
  }
  EXPECT_NEAR(highest, 0.05, 1e-5);
  EXPECT_LT((f.arm.pose().translation() - from - Eigen::Vector3d(0, -0.1, 0)).norm(), 1e-6);
}

TEST(Manipulator, reaches_poses_with_a_base_and_a_control_point) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.arm.set_base(moved(1, 2, 0.5)).is_ok());
  ASSERT_TRUE(f.arm.set_tool(moved(0, 0, 0.1)).is_ok());
  Pose goal = moved(1.4, 2.1, 0.6);
  goal.linear() = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()).toRotationMatrix();
  ASSERT_TRUE(f.pose(goal).is_ok());
  f.run();
  EXPECT_LT(arms::difference(f.arm.pose(), goal).norm(), 1e-6);
}

TEST(Manipulator, queues_motions_and_says_when_the_queue_is_full) {
  Arm f;
  f.on();
  for (std::size_t i = 0; i < Manipulator::max_motions; ++i) ASSERT_TRUE(f.joints({i % 2 == 0 ? 0.1 : 0.0, 0, 1, 0, 1, 0}).is_ok()) << i;
  EXPECT_TRUE(f.arm.state() & Manipulator::is_full);
  EXPECT_EQ(f.joints(f.at).answer, Answer::queue_full);
  f.run();
  EXPECT_EQ(f.at, (Positions{0, 0, 1, 0, 1, 0}));
  EXPECT_FALSE(f.arm.state() & Manipulator::is_full);
}

TEST(Manipulator, pauses_and_resumes_on_its_path) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
  f.steps(500);
  ASSERT_TRUE(f.arm.pause().is_ok());
  EXPECT_TRUE(f.arm.state() & Manipulator::is_paused);
  f.steps(300);
  const double paused = f.at[0];
  f.steps(500);
  EXPECT_EQ(f.at[0], paused);
  EXPECT_TRUE(f.joints({2.5, 0, 1, 0, 1, 0}).is_ok()) << "waits";
  f.steps(500);
  EXPECT_EQ(f.at[0], paused);
  EXPECT_TRUE(f.is_moving());
  ASSERT_TRUE(f.arm.resume().is_ok());
  f.run();
  EXPECT_EQ(f.at[0], 2.5);
}

TEST(Manipulator, stops_on_its_path_and_takes_the_next_motion_at_once) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
  ASSERT_TRUE(f.joints({-2, 0, 1, 0, 1, 0}).is_ok());
  f.steps(800);
  const double before = f.at[0];
  ASSERT_TRUE(f.arm.stop().is_ok());
  ASSERT_TRUE(f.joints({0.1, 0, 0, 0, 0, 0}, true).is_ok()) << "from where the arm will stand";
  double previous = before, highest = before, fastest_change = 0, last = M_PI / 2 * 0.001;
  while (f.is_moving()) {
    f.step();
    fastest_change = std::max(fastest_change, std::abs(f.at[0] - previous - last));
    last = f.at[0] - previous, previous = f.at[0];
    highest = std::max(highest, f.at[0]);
  }
  EXPECT_NEAR(f.at[0], before + M_PI / 2 * 0.1 + 0.1, 0.01) << "0.2 s from pi/2 rad/s to rest, then 0.1 rad";
  EXPECT_LT(fastest_change, 2e-5) << "no jump of the velocity [rad a step]";
}

TEST(Manipulator, forgets_the_queue_at_a_stop_while_it_is_paused) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
  f.steps(500);
  ASSERT_TRUE(f.arm.pause().is_ok());
  f.steps(500);
  ASSERT_TRUE(f.arm.stop().is_ok());
  EXPECT_EQ(f.arm.state(), Manipulator::has_servo);
  const auto before = f.at;
  f.steps(500);
  EXPECT_EQ(f.at, before);
}

TEST(Manipulator, drops_the_queue_when_the_servo_goes_off_and_stays_there_when_it_comes_on) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
  f.steps(500);
  ASSERT_TRUE(f.arm.set_servo(false).is_ok());
  EXPECT_EQ(f.arm.state(), 0u);
  EXPECT_FALSE(f.arm.advance(0.001));
  f.on();
  f.on();
  const auto before = f.at;
  f.steps(100);
  EXPECT_EQ(f.at, before);
}

TEST(Manipulator, rejects_a_motion_that_was_planned_before_a_stop) {
  Arm f;
  f.on();
  const auto planning = std::get<Manipulator::Planning>(f.arm.planning());
  auto plan = planning.planner.to_joints(planning.from, {1, 0, 1, 0, 1, 0}, false);
  ASSERT_TRUE(f.arm.set_servo(false).is_ok());
  f.on();
  EXPECT_EQ(f.arm.add(std::move(*plan.motion), planning.drops).answer, Answer::wrong_state);
}

TEST(Manipulator, raises_an_alarm_when_the_arm_passes_a_soft_limit_and_can_be_moved_back) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.arm.set_soft_limits({{-1, 1}, {-1.9, 1.9}, {-0.3, 2.6}, {-3, 3}, {-2, 2}, {-3, 3}}).is_ok());
  EXPECT_EQ(f.joints({1.5, 0, 1, 0, 1, 0}).answer, Answer::wrong_value);
  f.at[0] = 1.1;  // pushed
  f.feed();
  ASSERT_EQ(f.arm.alarms().size(), 1u);
  EXPECT_EQ(f.arm.alarms()[0].code, 4u);
  EXPECT_EQ(f.arm.alarms()[0].description, "joint 1 is at 1.1, beyond its soft limits -1 and 1");
  EXPECT_EQ(f.joints({0, 0, 1, 0, 1, 0}).answer, Answer::wrong_state);
  EXPECT_EQ(f.arm.set_soft_limits({}).answer, Answer::wrong_state);
  ASSERT_TRUE(f.arm.clear_alarms().is_ok());
  ASSERT_TRUE(f.joints({0, 0, 1, 0, 1, 0}).is_ok());
  f.run();
  EXPECT_TRUE(f.arm.alarms().empty());
  EXPECT_EQ(f.at[0], 0);
}

TEST(Manipulator, keeps_the_control_point_within_the_cartesian_limits) {
  Arm f;
  f.on();
  const Eigen::Vector3d at = f.arm.pose().translation();
  ASSERT_TRUE(f.arm.set_box({{{-2, 2}, {-0.3, 0.3}, {at.z() - 0.05, 2}}}).is_ok());
  EXPECT_EQ(f.line(moved(0, 0, -0.1), true).answer, Answer::wrong_value);
  EXPECT_EQ(f.joints({1.5, 0, 1, 0, 1, 0}).answer, Answer::wrong_value) << "joints as well";
  ASSERT_TRUE(f.line(moved(0, 0, -0.04), true).is_ok());
  f.run();
  f.at[0] = 1.5;  // pushed
  f.feed();
  ASSERT_EQ(f.arm.alarms().size(), 1u);
  EXPECT_EQ(f.arm.alarms()[0].code, 5u);
}

TEST(Manipulator, stops_with_an_alarm_when_a_joint_is_overloaded) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
  f.steps(500);
  f.arm.feed({f.at, 0, true, 1});
  ASSERT_EQ(f.arm.alarms().size(), 1u);
  EXPECT_EQ(f.arm.alarms()[0].code, 2u);
  EXPECT_EQ(f.arm.state(), Manipulator::has_servo | Manipulator::has_alarm);
  const auto before = f.at;
  f.steps(100);
  EXPECT_EQ(f.at, before);
}

TEST(Manipulator, stops_with_an_alarm_when_a_joint_is_faster_than_its_motor) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
  f.steps(500);
  const auto drive = [&](double speed, int steps) {
    for (int i = 0; i < steps; ++i) {
      f.at[2] += speed * 0.001;
      f.arm.feed({f.at, 0, true, {}});
      (void)f.arm.advance(0.001);
    }
  };
  for (int i = 0; i < 200; ++i) drive(i % 2 == 0 ? 20 : -20, 1);
  EXPECT_TRUE(f.arm.alarms().empty()) << "it rattles, and goes nowhere";
  drive(-5.5, 200);
  ASSERT_EQ(f.arm.alarms().size(), 1u) << "once";
  EXPECT_EQ(f.arm.alarms()[0].code, 3u);
  EXPECT_EQ(f.arm.alarms()[0].description.substr(0, 16), "joint 3 moves at");
  EXPECT_EQ(f.arm.state() & ~Manipulator::is_moving, Manipulator::has_servo | Manipulator::has_alarm);
  EXPECT_TRUE(f.arm.clear_alarms().is_ok());
  drive(0, 100);
  EXPECT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
}

TEST(Manipulator, is_off_while_the_signal_of_the_emergency_stop_is_on) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
  f.steps(500);
  f.arm.set_emergency(true);
  f.arm.set_emergency(true);
  ASSERT_EQ(f.arm.alarms().size(), 1u);
  EXPECT_EQ(f.arm.alarms()[0].code, 1u);
  EXPECT_TRUE(f.arm.alarms()[0].is_fault);
  EXPECT_EQ(f.arm.state(), Manipulator::has_alarm) << "no servo, nothing queued";
  EXPECT_FALSE(f.arm.advance(0.001)) << "the brakes hold";
  EXPECT_EQ(f.arm.clear_alarms().answer, Answer::wrong_state);
  EXPECT_EQ(f.arm.set_servo(true).answer, Answer::wrong_state);
  f.arm.restart();
  EXPECT_EQ(f.arm.alarms().size(), 1u) << "a reset of the world presses no button";
  f.arm.set_emergency(false);
  EXPECT_EQ(f.joints({2, 0, 1, 0, 1, 0}).answer, Answer::servo_off);
  ASSERT_TRUE(f.arm.set_servo(true).is_ok());
  EXPECT_EQ(f.joints({2, 0, 1, 0, 1, 0}).answer, Answer::wrong_state) << "the alarm is there until it is cleared";
  EXPECT_TRUE(f.arm.clear_alarms().is_ok());
  EXPECT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
}

TEST(Manipulator, moves_the_gripper_in_the_order_of_the_queue) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({0.5, 0, 1, 0, 1, 0}).is_ok());
  ASSERT_TRUE(f.arm.move_fingers({FingerCommand::Kind::close, 0}).is_ok());
  ASSERT_TRUE(f.joints({1, 0, 1, 0, 1, 0}).is_ok());
  f.are_fingers_still = false;
  f.steps(5000);
  EXPECT_EQ(f.fingers, (std::vector<FingerCommand>{{FingerCommand::Kind::close, 0}}));
  EXPECT_EQ(f.at[0], 0.5) << "waits for the fingers";
  EXPECT_TRUE(f.is_moving());
  f.are_fingers_still = true;
  f.run();
  EXPECT_EQ(f.at[0], 1);
  EXPECT_EQ(f.fingers.size(), 1u);
}

TEST(Manipulator, holds_the_fingers_when_it_stops_while_they_move) {
  Arm f;
  f.on();
  f.are_fingers_still = false;
  ASSERT_TRUE(f.arm.move_fingers({FingerCommand::Kind::move, 0.5}).is_ok());
  f.steps(50);
  ASSERT_TRUE(f.arm.stop().is_ok());
  f.steps(1);
  ASSERT_EQ(f.fingers.size(), 2u);
  EXPECT_EQ(f.fingers[1].kind, FingerCommand::Kind::hold);
  EXPECT_FALSE(f.is_moving());
}

TEST(Manipulator, follows_low_level_positions_and_holds_the_last) {
  Arm f;
  EXPECT_EQ(f.arm.follow(f.at).answer, Answer::servo_off);
  f.on();
  for (int i = 1; i <= 100; ++i) {
    ASSERT_TRUE(f.arm.follow({0.001 * i, 0, 1, 0, 1, 0}).is_ok());
    f.step();
    ASSERT_NEAR(f.at[0], 0.001 * i, 1e-12);
  }
  f.steps(100);
  EXPECT_NEAR(f.at[0], 0.1, 1e-12);
  EXPECT_FALSE(f.is_moving());
  ASSERT_TRUE(f.arm.follow({1, 0, 1, 0, 1, 0}).is_ok()) << "a jump";
  const double before = f.at[0];
  f.step();
  EXPECT_LE(f.at[0] - before, M_PI * 0.001 + 1e-12) << "at the highest speed";
  f.run();
  EXPECT_EQ(f.at[0], 1);
  ASSERT_TRUE(f.joints({0, 0, 1, 0, 1, 0}).is_ok());
  EXPECT_EQ(f.arm.follow(f.at).answer, Answer::wrong_state) << "motions of the middle level are queued";
}

TEST(Manipulator, forgets_motions_alarms_and_the_servo_when_the_world_is_reset) {
  Arm f;
  f.on();
  ASSERT_TRUE(f.joints({2, 0, 1, 0, 1, 0}).is_ok());
  f.steps(500);
  f.at = {0, 0, 1, 0, 1, 0};
  f.feed();
  f.arm.restart();
  EXPECT_EQ(f.arm.state(), 0u);
  f.on();
  f.steps(10);
  EXPECT_EQ(f.at, (Positions{0, 0, 1, 0, 1, 0}));
}

}  // namespace
}  // namespace manipulators

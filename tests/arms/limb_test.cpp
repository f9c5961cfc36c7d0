// An arm whose tip goes to poses, without the wire: lines, ways through joint space, streams of poses, stops.
#include "arms/limb.h"

#include <gtest/gtest.h>
#include <shm/layout.h>

#include <cmath>
#include <cstring>

namespace {

using arms::Limb;
using Pose = Eigen::Isometry3d;

shm::Joint joint_of_limb(const char* name, std::uint32_t parent, double z, int axis, double low, double high) {
  shm::Joint made{};
  std::strcpy(made.name, name);
  made.id = parent;
  made.kind = RTMSIM_JOINT_TURNS, made.parent = parent;
  made.lower = low, made.upper = high, made.max_velocity = M_PI;
  made.axis[axis] = 1;
  made.pose = shm::identity_pose;
  made.pose.z = z;
  return made;
}

// Whose joints do at once what they are told.
struct Arm {
  explicit Arm(double speed = 0.25) {
    const std::vector<shm::Joint> joints = {joint_of_limb("waist", 0, 0.1, 2, -2.9, 2.9),  joint_of_limb("shoulder", 1, 0.15, 1, -1.9, 1.9),
                                            joint_of_limb("elbow", 2, 0.35, 1, -0.3, 2.6), joint_of_limb("roll", 3, 0.15, 2, -3.1, 3.1),
                                            joint_of_limb("pitch", 4, 0.2, 1, -2.1, 2.1),  joint_of_limb("twist", 5, 0.08, 2, -4.7, 4.7)};
    EXPECT_TRUE(limb.begin(joints, 0.09, speed));
    limb.measure(at);
  }
  Limb::Command tick() {
    const Limb::Command command = limb.advance(dt);
    if (command.kind == Limb::Command::Kind::follow) at = command.positions;
    limb.measure(at);
    seconds += dt;
    return command;
  }
  void run(double most = 30) {
    const double end = seconds + most;
    do tick();
    while (limb.status() == Limb::Status::moving && seconds < end);
  }
  Eigen::Vector3d place() const { return limb.pose().translation(); }

  static constexpr double dt = 0.001;
  Limb limb;
  std::vector<double> at{0, 0.3, 1.5, 0, 1.2, 0};
  double seconds = 0;
};

Pose down_at(double x, double y, double z) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, z);
  pose.rotate(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY()));
  return pose;
}

TEST(Limb, commands_nothing_before_it_has_a_goal) {
  Arm arm;
  EXPECT_EQ(arm.tick().kind, Limb::Command::Kind::none);
  arm.limb.set_power(true);
  EXPECT_EQ(arm.tick().kind, Limb::Command::Kind::none);
  EXPECT_EQ(arm.limb.status(), Limb::Status::idle);
}

TEST(Limb, goes_on_a_straight_line_with_its_speed) {
  Arm arm;
  ASSERT_TRUE(arm.limb.go(down_at(0.45, 0, 0.2)).is_ok());
  arm.run();
  const Eigen::Vector3d from = arm.place(), to(0.45, 0.2, 0.3);
  ASSERT_LT((from - Eigen::Vector3d(0.45, 0, 0.2)).norm(), 1e-5);
  const double start = arm.seconds;
  ASSERT_TRUE(arm.limb.go(down_at(0.45, 0.2, 0.3)).is_ok());
  const Eigen::Vector3d line = (to - from).normalized();
  double worst = 0, fastest = 0;
  while (arm.limb.status() == Limb::Status::moving || arm.seconds == start) {
    const Eigen::Vector3d before = arm.place();
    arm.tick();
    const Eigen::Vector3d off = arm.place() - from;
    worst = std::max(worst, (off - off.dot(line) * line).norm());
    fastest = std::max(fastest, (arm.place() - before).norm() / Arm::dt);
    ASSERT_LT(arm.seconds, start + 10);
  }
  EXPECT_LT((arm.place() - to).norm(), 1e-5);
  EXPECT_LT(worst, 1e-4);
  EXPECT_NEAR(fastest, 0.25, 0.002);
  EXPECT_NEAR(arm.seconds - start, (to - from).norm() / 0.25 + 0.5, 0.05) << "a trapezoid of speed";
}

// A stop at each of them would need 0.4 s for each: they would be done after 20 s.
TEST(Limb, follows_a_stream_of_poses_without_stops) {
  Arm arm;
  ASSERT_TRUE(arm.limb.go(down_at(0.45, -0.2, 0.25)).is_ok());
  arm.run();
  const double start = arm.seconds;
  for (int i = 1; i <= 50; ++i) {
    ASSERT_TRUE(arm.limb.go(down_at(0.45, -0.2 + 0.008 * i, 0.25)).is_ok()) << i;
    for (int k = 0; k < 40; ++k) arm.tick();
  }
  arm.run();
  EXPECT_LT((arm.place() - Eigen::Vector3d(0.45, 0.2, 0.25)).norm(), 1e-5);
  EXPECT_LT(arm.seconds - start, 0.4 / 0.2 + 1);
}

TEST(Limb, takes_a_pose_that_is_sent_again_as_one) {
  Arm arm;
  const auto seconds_of = [](Arm& each, int ticks_between) {
    for (int i = 0; each.seconds < 20; ++i) {
      if (i % ticks_between == 0) {
        EXPECT_TRUE(each.limb.go(down_at(-0.3, 0.3, 0.2)).is_ok()) << "behind it: not on a line";
      }
      each.tick();
      if (each.limb.status() != Limb::Status::moving) return each.seconds;
    }
    return each.seconds;
  };
  Arm other;
  EXPECT_EQ(seconds_of(arm, 1'000'000), seconds_of(other, 20));
}

TEST(Limb, keeps_its_motion_when_a_pose_is_not_possible) {
  Arm arm;
  ASSERT_TRUE(arm.limb.go(down_at(0.45, 0.1, 0.2)).is_ok());
  for (int i = 0; i < 100; ++i) arm.tick();
  for (int i = 0; i < 3; ++i) {
    const arms::Reply far = arm.limb.go(down_at(3, 0, 0.2));
    EXPECT_EQ(far.comment, "the arm cannot reach the pose");
  }
  Pose bad = down_at(0.4, 0, 0.2);
  bad.linear() *= 2;
  EXPECT_EQ(arm.limb.go(bad).comment, "a pose must be finite, its axes orthonormal");
  bad = down_at(std::nan(""), 0, 0.2);
  EXPECT_FALSE(arm.limb.go(bad).is_ok());
  arm.run();
  EXPECT_LT((arm.place() - Eigen::Vector3d(0.45, 0.1, 0.2)).norm(), 1e-5);
  EXPECT_EQ(arm.limb.status(), Limb::Status::out_of_reach);
  ASSERT_TRUE(arm.limb.go(down_at(0.45, 0, 0.2)).is_ok());
  arm.run();
  EXPECT_EQ(arm.limb.status(), Limb::Status::idle);
}

TEST(Limb, comes_to_rest_where_it_is_stopped) {
  Arm arm;
  ASSERT_TRUE(arm.limb.go(down_at(0.45, -0.2, 0.25)).is_ok());
  arm.run();
  ASSERT_TRUE(arm.limb.go(down_at(0.45, 0.2, 0.25)).is_ok());
  for (int i = 0; i < 800; ++i) arm.tick();
  const Eigen::Vector3d at = arm.place();
  arm.limb.stop();
  arm.run();
  EXPECT_GT(arm.place().y(), at.y());
  EXPECT_LT((arm.place() - at).norm(), 0.07) << "0.25 m/s within half a second";
  EXPECT_NEAR(arm.place().z(), 0.25, 1e-4);
  ASSERT_TRUE(arm.limb.go_home().is_ok());
  for (int i = 0; i < 300; ++i) arm.tick();
  arm.limb.stop();
  arm.run();
  const auto rest = arm.at;
  for (int i = 0; i < 100; ++i) arm.tick();
  EXPECT_EQ(arm.at, rest);
}

TEST(Limb, goes_to_places_and_along_directions) {
  Arm arm;
  ASSERT_TRUE(arm.limb.go(down_at(0.45, 0, 0.25)).is_ok());
  arm.run();
  ASSERT_TRUE(arm.limb.go_along({0, 0, -2}, 0.1).is_ok());
  arm.run();
  EXPECT_LT((arm.place() - Eigen::Vector3d(0.45, 0, 0.15)).norm(), 1e-5);
  EXPECT_FALSE(arm.limb.go_along({0, 0, 0}, 0.1).is_ok());
  EXPECT_FALSE(arm.limb.go_along({0, 0, 1}, std::nan("")).is_ok());
  ASSERT_TRUE(arm.limb.go_to_place({0.45, 0.1, 0.3}).is_ok());
  arm.run();
  EXPECT_LT((arm.limb.pose().matrix() - down_at(0.45, 0.1, 0.3).matrix()).norm(), 1e-4) << "the orientation as it was";
  ASSERT_TRUE(arm.limb.go_to_place({0.3, 0, 0.9}).is_ok()) << "not with the hand down";
  arm.run();
  EXPECT_LT((arm.place() - Eigen::Vector3d(0.3, 0, 0.9)).norm(), 1e-4);
  EXPECT_FALSE(arm.limb.go_to_place({2, 0, 0.9}).is_ok());
}

TEST(Limb, is_held_by_its_brakes_and_without_power) {
  Arm arm;
  ASSERT_TRUE(arm.limb.go(down_at(0.45, 0, 0.25)).is_ok());
  for (int i = 0; i < 200; ++i) arm.tick();
  arm.limb.set_brakes(true);
  EXPECT_EQ(arm.tick().kind, Limb::Command::Kind::brake);
  EXPECT_EQ(arm.tick().kind, Limb::Command::Kind::none);
  EXPECT_EQ(arm.limb.status(), Limb::Status::braked);
  EXPECT_EQ(arm.limb.go(down_at(0.45, 0, 0.3)).comment, "the brakes are on");
  arm.limb.set_power(false);
  arm.limb.set_brakes(false);
  EXPECT_EQ(arm.limb.go_home().comment, "the power is off");
  arm.limb.set_power(true);
  EXPECT_EQ(arm.tick().kind, Limb::Command::Kind::follow) << "it holds itself again";
  EXPECT_EQ(arm.limb.status(), Limb::Status::idle);
}

TEST(Limb, stays_where_something_blocks_it) {
  Arm arm;
  ASSERT_TRUE(arm.limb.go(down_at(0.45, 0, 0.25)).is_ok());
  for (int i = 0; i < 200; ++i) arm.tick();
  const auto there = arm.at;
  arm.limb.measure(there, true);
  for (int i = 0; i < 200; ++i) arm.tick();
  EXPECT_EQ(arm.at, there);
  EXPECT_EQ(arm.limb.status(), Limb::Status::collision);
  ASSERT_TRUE(arm.limb.go(down_at(0.45, 0, 0.25)).is_ok());
  arm.run();
  EXPECT_EQ(arm.limb.status(), Limb::Status::idle);
}

TEST(Limb, is_none_of_joints_that_are_no_chain) {
  Limb limb;
  const std::vector<shm::Joint> joints = {joint_of_limb("a", 0, 0.1, 2, -1, 1), joint_of_limb("b", 0, 0.1, 2, -1, 1)};
  EXPECT_FALSE(limb.begin(joints, 0, 0.25));
  EXPECT_EQ(limb.go(down_at(0, 0, 0)).answer, arms::Answer::fault);
  EXPECT_EQ(limb.advance(0.001).kind, Limb::Command::Kind::none);
}

}  // namespace

// How robots get to poses: from anywhere to anywhere, within their limits, by odometry that comes late.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "shm/pose_control.h"

namespace shm {
namespace {

constexpr double pi = std::numbers::pi;

double between(double a, double b) { return std::abs(std::remainder(a - b, 2 * pi)); }

// Follows each command one sample later, as fast as its motors can.
class Robot {
 public:
  Robot(const PlanarPose& pose, const DriveLimits& limits) : pose_(pose), limits_(limits) {}

  void follow(const PlanarPose& command) {
    const double dt = 1 / limits_.rate;
    const auto approach = [](double from, double to, double most) { return from + std::clamp(to - from, -most, most); };
    velocity_.x = approach(velocity_.x, late_.x, 2 * limits_.acceleration * dt);
    velocity_.y = limits_.is_holonomic ? approach(velocity_.y, late_.y, 2 * limits_.acceleration * dt) : 0;
    velocity_.a = approach(velocity_.a, late_.a, 2 * limits_.turn_acceleration * dt);
    const double heading = pose_.a + velocity_.a * dt / 2;
    pose_.x += (velocity_.x * std::cos(heading) - velocity_.y * std::sin(heading)) * dt;
    pose_.y += (velocity_.x * std::sin(heading) + velocity_.y * std::cos(heading)) * dt;
    pose_.a = std::remainder(pose_.a + velocity_.a * dt, 2 * pi);
    late_ = command;
  }
  const PlanarPose& pose() const { return pose_; }
  const PlanarPose& velocity() const { return velocity_; }

 private:
  PlanarPose pose_, velocity_, late_;
  DriveLimits limits_;
};

// [s] until it has arrived and stands; checks on the way.
double travel(const PlanarPose& from, const PlanarPose& to, const DriveLimits& limits) {
  Robot robot(from, limits);
  PoseControl way(to, limits);
  double time = 0;
  while ((!way.has_arrived() || std::abs(robot.velocity().x) > 0 || std::abs(robot.velocity().a) > 0) && time < 300) {
    const auto command = way.next(robot.pose());
    EXPECT_LE(std::hypot(command.x, command.y), limits.speed + 1e-9);
    EXPECT_LE(std::abs(command.a), limits.turn + 1e-9);
    EXPECT_TRUE(limits.is_holonomic || command.y == 0);
    robot.follow(command);
    time += 1 / limits.rate;
  }
  EXPECT_LT(std::hypot(robot.pose().x - to.x, robot.pose().y - to.y), 0.02) << to.x << ' ' << to.y << ' ' << to.a;
  EXPECT_LT(between(robot.pose().a, to.a), 0.02) << to.x << ' ' << to.y << ' ' << to.a;
  return time;
}

TEST(PoseControl, arrives_from_anywhere_in_about_the_time_that_it_takes) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-3, 3), angle(-pi, pi);
  for (const double rate : {50.0, 10.0, 2.0}) {
    for (const bool is_holonomic : {false, true}) {
      const DriveLimits limits{.rate = rate, .is_holonomic = is_holonomic};
      for (int i = 0; i < 200; ++i) {
        const PlanarPose from{place(random), place(random), angle(random)}, to{place(random), place(random), angle(random)};
        const double distance = std::hypot(to.x - from.x, to.y - from.y);
        EXPECT_LT(travel(from, to, limits), distance / limits.speed + 2 * pi / limits.turn + (rate < 5 ? 30 : 15));
      }
    }
  }
}

TEST(PoseControl, goal_beside_behind_or_where_it_stands) {
  const DriveLimits limits;
  for (const PlanarPose& goal : {PlanarPose{0, 0.03, 0}, PlanarPose{-0.02, 0, 0}, PlanarPose{0.005, 0.005, pi}, PlanarPose{-1, 0, 0},
                                 PlanarPose{0, 0, 7}, PlanarPose{1, 0, -9}})
    travel({}, goal, limits);
  PoseControl there({}, limits);
  EXPECT_EQ(there.next({0.001, 0, 0.001}).a, 0);
  EXPECT_TRUE(there.has_arrived());
  EXPECT_EQ(there.next({5, 5, 1}).x, 0);  // and has arrived for good
}

TEST(PoseControl, turns_on_the_spot_first_and_by_the_shorter_way) {
  PoseControl way({-1, -0.2, 0}, {});
  const auto first = way.next({0, 0, pi / 2});
  EXPECT_EQ(first.x, 0);
  EXPECT_GT(first.a, 0);
  PoseControl sideways({0, 1, 0}, {.is_holonomic = true});
  const auto move = sideways.next({});
  EXPECT_NEAR(move.x, 0, 1e-9);
  EXPECT_GT(move.y, 0.3);
}

TEST(PoseControl, brakes_no_harder_than_it_may) {
  const DriveLimits limits{.speed = 2, .acceleration = 0.5, .rate = 50};
  PoseControl way({10, 0, 0}, limits);
  double x = 0, before = 0;
  for (int i = 0; i < 5000 && !way.has_arrived(); ++i) {
    const double speed = way.next({x, 0, 0}).x;
    if (before > 0 && speed > 0.03) {
      EXPECT_GT((speed - before) * limits.rate, -limits.acceleration - 1e-6);
    }
    before = speed;
    x += speed / limits.rate;
  }
  EXPECT_TRUE(way.has_arrived());
}

TEST(PoseControl, goal_out_of_all_bounds_has_finite_velocities) {
  PoseControl way({1e308, -1e308, 1e308}, {});
  for (int i = 0; i < 10; ++i) {
    const auto command = way.next({0, 0, -0.8});
    EXPECT_TRUE(std::isfinite(command.x) && std::isfinite(command.a));
  }
}

TEST(TurnTowards, takes_the_shorter_way_within_the_limit) {
  EXPECT_GT(turn_towards(3, -3, {}), 0);
  EXPECT_LT(turn_towards(-3, 3, {}), 0);
  EXPECT_EQ(turn_towards(0, 2, {.turn = 0.3}), 0.3);
  EXPECT_NEAR(turn_towards(1, 1, {}), 0, 1e-12);
}

}  // namespace
}  // namespace shm

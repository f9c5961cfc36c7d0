// Kinematics of the arm behind RTCManipulator, against the worked numbers of UR5 and against its own inverse on ten random chains.
#include "arms/arm_kinematics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace {

using arms::ArmKinematics;
using std::numbers::pi;

shm::Joint joint_at(const Eigen::Isometry3d& place, const Eigen::Vector3d& axis, bool slides, double low, double high) {
  shm::Joint made{};
  made.kind = slides ? RTMSIM_JOINT_SLIDES : RTMSIM_JOINT_TURNS;
  made.lower = low, made.upper = high, made.max_velocity = 1;
  for (int k = 0; k < 3; ++k) made.axis[k] = axis[k];
  const Eigen::Quaterniond turn(place.linear());
  made.pose = {place.translation().x(), place.translation().y(), place.translation().z(), turn.w(), turn.x(), turn.y(), turn.z()};
  return made;
}

// Denavit-Hartenberg: the joint turns about the z axis of the frame before; what follows it carries the next joint.
struct Row {
  double d, a, alpha;
};

Eigen::Isometry3d after(const Row& row) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Eigen::Vector3d(row.a, 0, row.d));
  pose.rotate(Eigen::AngleAxisd(row.alpha, Eigen::Vector3d::UnitX()));
  return pose;
}

struct Robot {
  explicit Robot(const std::vector<Row>& rows) {
    std::vector<shm::Joint> joints;
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    for (const Row& row : rows) {
      joints.push_back(joint_at(place, Eigen::Vector3d::UnitZ(), false, -2 * pi, 2 * pi));
      place = after(row);
    }
    last = place;
    kinematics = ArmKinematics(joints);
  }
  Eigen::Isometry3d tip(const std::vector<double>& q) const { return kinematics.tip(q) * last; }
  Eigen::Isometry3d last;
  ArmKinematics kinematics;
};

const Robot& ur5() {
  static const Robot robot(
      {{.089159, 0, pi / 2}, {0, -.425, 0}, {0, -.39225, 0}, {.10915, 0, pi / 2}, {.09465, 0, -pi / 2}, {.0823, 0, 0}});
  return robot;
}

void expect_at(const Eigen::Isometry3d& pose, double x, double y, double z) {
  EXPECT_NEAR(pose.translation().x(), x, 1e-6);
  EXPECT_NEAR(pose.translation().y(), y, 1e-6);
  EXPECT_NEAR(pose.translation().z(), z, 1e-6);
}

TEST(ArmKinematics, has_the_poses_of_ur5) {
  expect_at(ur5().tip({0, 0, 0, 0, 0, 0}), -0.81725, -0.19145, -0.005491);
  expect_at(ur5().tip({0, -pi / 2, 0, 0, 0, 0}), -0.09465, -0.19145, 0.906409);
  expect_at(ur5().tip({0, -pi / 2, pi / 2, -pi / 2, -pi / 2, 0}), -0.4869, -0.10915, 0.431859);
  const Eigen::Isometry3d pose = ur5().tip({.3, -1.2, 1.5, -.9, -1.1, .7});
  expect_at(pose, -0.455054, -0.294094, 0.249825);
  Eigen::Matrix3d turn;
  turn << .41961, .35184, .83674, .8433, -.49214, -.21597, .3358, .79625, -.50321;
  EXPECT_LT((pose.linear() - turn).cwiseAbs().maxCoeff(), 1e-5);
}

double random_in(std::mt19937& random, double low, double high) { return low + (high - low) * (random() / 4294967296.0); }

Eigen::Vector3d random_axis(std::mt19937& random) {
  Eigen::Vector3d axis(random_in(random, -1, 1), random_in(random, -1, 1), random_in(random, -1, 1));
  return axis.norm() < 0.1 ? Eigen::Vector3d::UnitX() : axis.normalized();
}

TEST(ArmKinematics, solves_poses_of_ten_random_chains_to_a_micrometre) {
  std::mt19937 random(20);
  double worst = 0;
  int solved = 0, asked = 0;
  for (int chain = 0; chain < 10; ++chain) {
    std::vector<shm::Joint> joints;
    for (int i = 0; i < 7; ++i) {
      Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
      place.translate(0.2 * random_axis(random));
      place.rotate(Eigen::AngleAxisd(random_in(random, -1.5, 1.5), random_axis(random)));
      const bool slides = i == 3 && chain % 3 == 0;
      joints.push_back(joint_at(place, random_axis(random), slides, slides ? -0.2 : -2.5, slides ? 0.2 : 2.5));
    }
    const ArmKinematics arm(joints);
    for (int pose = 0; pose < 10; ++pose) {
      std::vector<double> goal, from;
      for (const auto& joint : joints) {
        goal.push_back(random_in(random, 0.9 * joint.lower, 0.9 * joint.upper));
        from.push_back(std::clamp(goal.back() + random_in(random, -0.5, 0.5), joint.lower, joint.upper));
      }
      const auto found = arm.solve(arm.tip(goal), from);
      ++asked;
      if (!found) continue;
      ++solved;
      for (std::size_t i = 0; i < joints.size(); ++i) {
        EXPECT_GE((*found)[i], joints[i].lower);
        EXPECT_LE((*found)[i], joints[i].upper);
      }
      worst = std::max(worst, arms::difference(arm.tip(goal), arm.tip(*found)).norm());
      EXPECT_EQ(arm.solve(arm.tip(goal), from), found) << "the same question has the same answer";
    }
  }
  RecordProperty("solved", solved);
  std::printf("solved %d of %d, worst error %.3g\n", solved, asked, worst);
  EXPECT_GE(solved, asked * 9 / 10);
  EXPECT_LT(worst, 1e-6);
}

TEST(ArmKinematics, finds_no_solution_where_there_is_none) {
  Eigen::Isometry3d goal = Eigen::Isometry3d::Identity();
  goal.translation().x() = 2;
  EXPECT_FALSE(ur5().kinematics.solve(goal, std::vector<double>(6, 0.1)));
  EXPECT_FALSE(ArmKinematics().solve(goal, {}));
}

}  // namespace

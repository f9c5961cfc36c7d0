// Kinematics and inverse dynamics against published arms and against KDL.
#include "physics/joint_dynamics.h"

#include <gtest/gtest.h>

#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <random>

#include "support/arms.h"

namespace sim {
namespace {

using namespace test;

std::vector<std::uint32_t> six_joints() { return {1, 2, 3, 4, 5, 6}; }

Eigen::Isometry3d tip_of(const ArmNumbers& numbers, const std::vector<double>& q) {
  const JointDynamics dynamics(arm_model(numbers), six_joints());
  std::vector<Eigen::Isometry3d> poses;
  dynamics.poses(q, poses);
  return poses.back() * dh_pose(numbers.table.back(), 0);
}

void expect_tip(const ArmNumbers& numbers, const std::vector<double>& q, const Eigen::Vector3d& place, const Eigen::Matrix3d& turn,
                double turn_tolerance) {
  const Eigen::Isometry3d tip = tip_of(numbers, q);
  EXPECT_LT((tip.translation() - place).norm(), 2e-6) << tip.translation().transpose();
  EXPECT_LT((tip.linear() - turn).cwiseAbs().maxCoeff(), turn_tolerance) << tip.linear();
}

Eigen::Matrix3d rows(double a, double b, double c, double d, double e, double f, double g, double h, double i) {
  Eigen::Matrix3d m;
  m << a, b, c, d, e, f, g, h, i;
  return m;
}

TEST(JointDynamics, the_tip_of_a_ur5_is_where_its_table_says) {
  constexpr double right = std::numbers::pi / 2;
  expect_tip(ur5(), {0, 0, 0, 0, 0, 0}, {-0.81725, -0.19145, -0.005491}, rows(1, 0, 0, 0, 0, -1, 0, 1, 0), 1e-9);
  EXPECT_LT((tip_of(ur5(), {0, -right, 0, 0, 0, 0}).translation() - Eigen::Vector3d(-0.09465, -0.19145, 0.906409)).norm(), 2e-6);
  expect_tip(ur5(), {0, -right, right, -right, -right, 0}, {-0.4869, -0.10915, 0.431859}, rows(0, 1, 0, 1, 0, 0, 0, 0, -1), 1e-9);
  const Eigen::Matrix3d turn = rows(.41961, .35184, .83674, .8433, -.49214, -.21597, .3358, .79625, -.50321);
  expect_tip(ur5(), {.3, -1.2, 1.5, -.9, -1.1, .7}, {-0.455054, -0.294094, 0.249825}, turn, 1e-5);
  expect_tip(ur10(), {.3, -1.2, 1.5, -.9, -1.1, .7}, {-0.670994, -0.422945, 0.386694}, turn, 1e-5);
}

std::vector<double> gravity_torques(const ArmNumbers& numbers, double payload) {
  const JointDynamics dynamics(arm_model(numbers, payload), six_joints());
  std::vector<double> efforts(6);
  dynamics.efforts(std::vector<double>(6, 0.0), {}, {}, {0, 0, -9.81}, efforts);
  return efforts;
}

TEST(JointDynamics, an_arm_stretched_level_needs_the_torques_of_its_weights) {
  const auto expect = [](const ArmNumbers& numbers, double payload, double shoulder, double elbow) {
    const auto efforts = gravity_torques(numbers, payload);
    EXPECT_NEAR(efforts[0], 0, 1e-9);
    EXPECT_NEAR(std::abs(efforts[1]), shoulder, 0.06) << payload;
    EXPECT_NEAR(std::abs(efforts[2]), elbow, 0.06) << payload;
  };
  expect(ur5(), 0, 50.7, 12.8);
  expect(ur5(), 5, 90.8, 32.0);
  expect(ur10(), 0, 127.8, 30.7);
  expect(ur10(), 5, 185.9, 58.7);
  expect(ur10(), 10, 244.0, 86.8);
}

// A chain of joints in any directions, some of which slide, and the same for KDL.
struct Chains {
  ModelDef model;
  std::vector<std::uint32_t> joints;
  KDL::Chain chain;
};

KDL::Frame kdl(const Eigen::Isometry3d& pose) {
  const auto& m = pose.linear();
  return {KDL::Rotation(m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)),
          KDL::Vector(pose.translation().x(), pose.translation().y(), pose.translation().z())};
}
KDL::Vector kdl(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

class Dice {
 public:
  explicit Dice(unsigned seed) : engine_(seed) {}
  double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Eigen::Vector3d vector(double size) { return {number(-size, size), number(-size, size), number(-size, size)}; }
  Eigen::Isometry3d pose() {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.translation() = vector(0.5);
    pose.linear() = Eigen::AngleAxisd(number(-3, 3), vector(1).normalized()).toRotationMatrix();
    return pose;
  }
  std::vector<double> numbers(std::size_t count) {
    std::vector<double> all;
    while (all.size() < count) all.push_back(number(-2, 2));
    return all;
  }

 private:
  std::mt19937 engine_;
};

Chains random_chain(Dice& dice, std::size_t count) {
  Chains made;
  made.model.links.push_back(link("l0", BoxShape{}, 1, at(0, 0, 0)));
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Isometry3d offset = dice.pose();
    frame = frame * offset;
    JointDef joint;
    joint.name = "j" + std::to_string(i);
    joint.kind = dice.number(0, 1) < 0.3 ? JointDef::Kind::prismatic : JointDef::Kind::revolute;
    joint.parent = made.model.links.back().name, joint.child = "l" + std::to_string(i + 1);
    joint.pose_in_model = frame;
    AxisDef axis;
    axis.xyz = dice.vector(1).normalized();
    joint.axes.push_back(axis);
    LinkDef moved;
    moved.name = joint.child, moved.pose = frame * dice.pose();
    moved.mass = dice.number(0.1, 5), moved.center_of_mass = dice.vector(0.3);
    const Eigen::Vector3d moments(dice.number(0.1, 0.15), dice.number(0.1, 0.15), dice.number(0.1, 0.15));
    const Eigen::Matrix3d turn = dice.pose().linear();
    moved.inertia = turn * moments.asDiagonal() * turn.transpose();
    made.model.links.push_back(moved);
    made.model.joints.push_back(joint);
    made.joints.push_back(static_cast<std::uint32_t>(i));
    // KDL's inertia is that about the centre of mass, in the frame behind the joint.
    const Eigen::Isometry3d in_joint = frame.inverse() * moved.pose;
    const Eigen::Matrix3d inertia = in_joint.linear() * moved.inertia * in_joint.linear().transpose();
    const KDL::RigidBodyInertia body(
        moved.mass, kdl(in_joint * moved.center_of_mass),
        KDL::RotationalInertia(inertia(0, 0), inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2)));
    const auto type = joint.kind == JointDef::Kind::prismatic ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
    made.chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), kdl(offset)));
    made.chain.addSegment(KDL::Segment(KDL::Joint(KDL::Vector::Zero(), kdl(axis.xyz), type), KDL::Frame::Identity(), body));
  }
  return made;
}

KDL::JntArray kdl(const std::vector<double>& values) {
  KDL::JntArray array(static_cast<unsigned>(values.size()));
  for (unsigned i = 0; i < values.size(); ++i) array(i) = values[i];
  return array;
}

TEST(JointDynamics, ten_random_chains_are_as_kdl_has_them) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Dice dice(seed);
    const std::size_t count = 2 + seed % 7;
    const Chains made = random_chain(dice, count);
    const auto q = dice.numbers(count), v = dice.numbers(count), a = dice.numbers(count);
    const JointDynamics dynamics(made.model, made.joints);
    std::vector<Eigen::Isometry3d> poses;
    dynamics.poses(q, poses);
    KDL::ChainFkSolverPos_recursive forward(made.chain);
    KDL::Frame tip;
    ASSERT_GE(forward.JntToCart(kdl(q), tip), 0);
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(poses.back().translation()[r], tip.p(r), 1e-9);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(poses.back().linear()(r, c), tip.M(r, c), 1e-9);
    }
    KDL::ChainIdSolver_RNE inverse(made.chain, KDL::Vector(0.5, -1, -9.81));
    KDL::JntArray torques(static_cast<unsigned>(count));
    const KDL::Wrenches none(made.chain.getNrOfSegments(), KDL::Wrench::Zero());
    ASSERT_GE(inverse.CartToJnt(kdl(q), kdl(v), kdl(a), none, torques), 0);
    std::vector<double> efforts(count);
    dynamics.efforts(q, v, a, {0.5, -1, -9.81}, efforts);
    for (unsigned i = 0; i < count; ++i) EXPECT_NEAR(efforts[i], torques(i), 1e-9 * std::max(1.0, std::abs(torques(i))));
  }
}

TEST(JointDynamics, joints_of_a_file_may_stand_in_any_order) {
  ModelDef model = arm_model(ur5(), 5);
  const JointDynamics dynamics(model, six_joints());
  std::vector<double> efforts(6), turned(6);
  const std::vector<double> q{.3, -1.2, 1.5, -.9, -1.1, .7}, backwards(q.rbegin(), q.rend());
  dynamics.efforts(q, {}, {}, {0, 0, -9.81}, efforts);
  const std::vector<std::uint32_t> last_first{6, 5, 4, 3, 2, 1};
  JointDynamics(model, last_first).efforts(backwards, {}, {}, {0, 0, -9.81}, turned);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_DOUBLE_EQ(efforts[i], turned[5 - i]);
}

}  // namespace
}  // namespace sim

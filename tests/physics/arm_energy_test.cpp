// Random arms of 3 to 9 joints, thrown and left alone: stops, turns beyond half a turn and the solvers give them no energy.
#include <gtest/gtest.h>

#include <random>

#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;
using Kind = JointDef::Kind;

struct Throw {
  unsigned seed = 0;
  bool has_gravity = false, is_held = false;
  PhysicsDef::Solver solver = PhysicsDef::Solver::automatic;
  bool has_all_kinds = false;  // or turning joints alone
};

class Arm {
 public:
  explicit Arm(const Throw& how) : how_(how), random_(how.seed) {
    model_.name = "arm";
    model_.canonical_link = "link0";
    model_.allow_auto_disable = false;
    const int joints = 3 + static_cast<int>(random_() % 7);
    add_link(0);
    if (how.is_held) add_joint("", "link0", 0);
    for (int i = 1; i <= joints; ++i) {
      // Most hang on the one before, some branch off.
      const int parent = random_() % 4 == 0 ? static_cast<int>(random_() % static_cast<unsigned>(i)) : i - 1;
      add_link(i);
      add_joint("link" + std::to_string(parent), "link" + std::to_string(i), i);
    }
  }
  ModelDef model() const { return model_; }
  std::mt19937& random() { return random_; }
  double any(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  Eigen::Vector3d any_vector(double most) { return {any(-most, most), any(-most, most), any(-most, most)}; }

 private:
  void add_link(int i) {
    const Eigen::Vector3d size(any(0.1, 0.3), any(0.04, 0.1), any(0.04, 0.1));
    LinkDef link = test::link("link" + std::to_string(i), BoxShape{size}, any(0.3, 2), at(0.2 * i, any(-0.05, 0.05), any(-0.05, 0.05)));
    link.collisions.clear();
    model_.links.push_back(link);
  }
  AxisDef any_axis(Kind kind) {
    AxisDef axis;
    axis.xyz = any_vector(1).normalized();
    const double scale = kind == Kind::prismatic ? 0.05 : 1;
    switch (random_() % 6) {
      case 0:
        break;
      case 1:
        axis.lower = -scale * any(0, 3);
        break;
      case 2:
        axis.upper = scale * any(0, 3);
        break;
      case 3:
        axis.lower = -scale * any(0, 1), axis.upper = scale * any(0, 1);
        break;
      case 4:
        axis.lower = -scale * any(0, 3), axis.upper = scale * any(3, 12);
        break;
      default:
        axis.lower = -scale * any(3, 12), axis.upper = scale * any(3, 12);
        break;
    }
    if (kind == Kind::continuous) axis.lower = -infinite, axis.upper = infinite;
    return axis;
  }
  void add_joint(const std::string& parent, const std::string& child, int i) {
    constexpr Kind kinds[] = {Kind::revolute,  Kind::revolute,  Kind::revolute, Kind::continuous,
                              Kind::prismatic, Kind::universal, Kind::ball};
    JointDef joint;
    joint.name = "joint" + std::to_string(i);
    joint.kind = how_.has_all_kinds ? kinds[random_() % std::size(kinds)] : Kind::revolute;
    joint.parent = parent, joint.child = child;
    joint.pose_in_model = at(0.2 * i - 0.1, any(-0.05, 0.05), any(-0.05, 0.05));
    if (joint.kind != Kind::ball) joint.axes.push_back(any_axis(joint.kind));
    if (joint.kind == Kind::universal) {
      joint.axes.push_back(any_axis(joint.kind));
      joint.axes[1].xyz = joint.axes[0].xyz.unitOrthogonal();
    }
    model_.joints.push_back(joint);
  }

  Throw how_;
  std::mt19937 random_;
  ModelDef model_;
};

// Of all links; what the whole has as it flies along is left out, unless it is held.
double energy_of(const PhysicsFixture& f, bool is_held) {
  const ModelDef& def = f.physics.def(0);
  double energy = 0, mass = 0;
  Eigen::Vector3d momentum(0, 0, 0);
  for (std::uint32_t i = 0; i < def.links.size(); ++i) {
    const LinkId link{0, i};
    const Twist twist = f.physics.link_twist(link);
    const Eigen::Vector3d turn = f.physics.link_pose(link).linear().transpose() * twist.angular;
    energy += 0.5 * def.links[i].mass * twist.linear.squaredNorm() + 0.5 * turn.dot(def.links[i].inertia * turn);
    if (is_held) energy -= def.links[i].mass * f.world->physics.gravity.dot(f.physics.link_pose(link).translation());
    momentum += def.links[i].mass * twist.linear;
    mass += def.links[i].mass;
  }
  return is_held ? energy : energy - 0.5 * momentum.squaredNorm() / mass;
}

struct Course {
  double first = 0, highest = 0, motion = 0;
  double at = 0;  // [s] of the highest
};

Course throw_arm(const Throw& how, double seconds) {
  Arm arm(how);
  WorldDef world = world_of({arm.model()});
  world.physics.solver = how.solver;
  if (!how.has_gravity) world.physics.gravity.setZero();
  PhysicsFixture f(std::move(world));
  const auto links = static_cast<std::uint32_t>(f.physics.def(0).links.size());
  for (std::uint32_t i = 0; i < links; ++i) {
    const double mass = f.physics.def(0).links[i].mass;
    EXPECT_TRUE(f.physics.add_wrench({0, i}, mass * arm.any_vector(1500), 0.01 * mass * arm.any_vector(3000)));
  }
  f.physics.step();
  Course course;
  course.first = course.highest = energy_of(f, how.is_held);
  double least = course.first;
  for (double t = 0; t < seconds; t += f.physics.step_length()) {
    f.physics.step();
    const double now = energy_of(f, how.is_held);
    least = std::min(least, now);
    if (now > course.highest) course.highest = now, course.at = t;
  }
  EXPECT_TRUE(f.physics.take_complaints().empty());
  return course;
}

constexpr unsigned throws = 60;

void expect_no_gain(Throw how, const char* what) {
  for (how.seed = 0; how.seed < throws; ++how.seed) {
    const Course course = throw_arm(how, 3);
    EXPECT_LT(course.highest, 1.01 * course.first)
        << what << ", seed " << how.seed << ": " << course.first << " J, highest after " << course.at << " s";
  }
}

TEST(ArmEnergy, does_not_rise_in_weightlessness) { expect_no_gain({}, "weightless"); }
TEST(ArmEnergy, does_not_rise_in_free_fall) { expect_no_gain({.has_gravity = true}, "free fall"); }
TEST(ArmEnergy, does_not_rise_of_an_arm_that_the_world_holds) { expect_no_gain({.is_held = true}, "held"); }
TEST(ArmEnergy, does_not_rise_with_joints_of_all_kinds) { expect_no_gain({.has_all_kinds = true}, "all kinds"); }
TEST(ArmEnergy, does_not_rise_with_the_iterative_solver) { expect_no_gain({.solver = PhysicsDef::Solver::iterative}, "iterative"); }

}  // namespace
}  // namespace sim

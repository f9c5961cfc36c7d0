// Impacts that go on from body to body, beside what mechanics says.
#include <gtest/gtest.h>

#include <random>

#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;

constexpr double ball_radius = 0.1;

ModelDef ball(const std::string& name, const Eigen::Isometry3d& pose, double restitution = 1) {
  ModelDef model = body(name, SphereShape{ball_radius}, pose);
  SurfaceDef& surface = model.links[0].collisions[0].surface;
  surface.restitution = restitution;
  surface.bounce_threshold = 0.01;
  surface.mu = surface.mu2 = 0;
  return model;
}

std::string name_of(int i) { return "ball" + std::to_string(i); }

// Balls that touch along x, without weight; the first `moving` or, to the left, the last ones come from a distance with 1 m/s.
struct Row {
  explicit Row(int moving, double sense = 1, double restitution = 1) : f(world(moving, sense, restitution)) {
    for (int i = 0; i < 5; ++i) {
      if (moves(i, moving, sense)) start(i, sense);
    }
    f.run(0.5);
  }
  static bool moves(int i, int moving, double sense) { return sense > 0 ? i < moving : i >= 5 - moving; }
  static WorldDef world(int moving, double sense, double restitution) {
    std::vector<ModelDef> balls;
    for (int i = 0; i < 5; ++i)
      balls.push_back(ball(name_of(i), at(2 * ball_radius * i - (moves(i, moving, sense) ? 0.05 * sense : 0), 0, 0), restitution));
    WorldDef world = world_of(balls);
    world.physics.gravity.setZero();
    return world;
  }
  void start(int i, double sense) { ASSERT_TRUE(f.physics.set_model_twist(f.id(name_of(i)), {{sense, 0, 0}, {0, 0, 0}})); }
  double speed(int i) const { return f.physics.link_twist(f.link(name_of(i) + "::link")).linear.x(); }
  PhysicsFixture f;
};

// All contacts at once: the first ball came back with 0.6 m/s, and the others left together.
TEST(Impacts, the_last_ball_of_a_row_takes_the_whole_impact_from_either_side) {
  for (const double sense : {1.0, -1.0}) {
    const Row row(1, sense);
    const int last = sense > 0 ? 4 : 0;
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(row.speed(i), i == last ? sense : 0, 2e-3) << i << " to " << sense;
  }
}

TEST(Impacts, as_many_balls_leave_a_row_as_have_come) {
  const Row row(2);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(row.speed(i), i >= 3 ? 1 : 0, 2e-3) << i;
}

TEST(Impacts, half_of_the_restitution_passes_three_quarters_of_the_speed_to_each_next_ball) {
  const Row row(1, 1, 0.5);
  EXPECT_NEAR(row.speed(4), std::pow(0.75, 4), 2e-3);
  double momentum = 0;
  for (int i = 0; i < 5; ++i) momentum += row.speed(i);
  EXPECT_NEAR(momentum, 1, 1e-9);
}

// A ball on a rod without mass that turns about y, 1 m above the rest of the ball, which is at `x`.
ModelDef pendulum(int i, double x, double angle) {
  const Eigen::Vector3d pivot(x, 0, 2);
  const Eigen::Vector3d place = pivot + Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()) * Eigen::Vector3d(0, 0, -1);
  ModelDef model = ball(name_of(i), at(place.x(), place.y(), place.z()));
  model.allow_auto_disable = false;
  JointDef joint;
  joint.name = "pivot";
  joint.kind = JointDef::Kind::continuous;
  joint.child = "link";
  joint.pose_in_model = Eigen::Isometry3d(Eigen::Translation3d(pivot - place));
  AxisDef axis;
  axis.xyz = {0, 1, 0};
  joint.axes.push_back(axis);
  model.joints.push_back(joint);
  return model;
}

double highest_of(PhysicsFixture& f, int i, double seconds) {
  double highest = 0;
  for (double t = 0; t < seconds; t += 0.01) {
    f.run(0.01);
    highest = std::max(highest, f.position(name_of(i)).z());
  }
  return highest;
}

// Of the solver that decides all contacts at once the last ball got 65 % of the energy.
TEST(Impacts, newtons_cradle_lifts_its_last_ball_as_high_as_the_first_one_was) {
  std::vector<ModelDef> balls;
  for (int i = 0; i < 5; ++i) balls.push_back(pendulum(i, 2 * ball_radius * i, i == 0 ? 0.4 : 0));
  PhysicsFixture f(world_of(balls));
  const double lifted = f.position(name_of(0)).z() - 1;
  EXPECT_NEAR(lifted, 1 - std::cos(0.4), 1e-9);
  f.run(0.3);
  EXPECT_NEAR(highest_of(f, 4, 1.2) - 1, lifted, 0.01 * lifted);
  // And back.
  EXPECT_NEAR(highest_of(f, 0, 2) - 1, lifted, 0.03 * lifted);
}

double energy_of(const PhysicsFixture& f, int count) {
  double energy = 0;
  for (int i = 0; i < count; ++i) energy += 0.5 * f.physics.link_twist(f.link(name_of(i) + "::link")).linear.squaredNorm();
  return energy;
}

TEST(Impacts, a_crowd_of_elastic_balls_gains_no_energy) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<ModelDef> balls;
  constexpr int count = 27;
  for (int i = 0; i < count; ++i) balls.push_back(ball(name_of(i), at(0.21 * (i % 3), 0.21 * (i / 3 % 3), 0.21 * (i / 9))));
  WorldDef world = world_of(balls);
  world.physics.gravity.setZero();
  PhysicsFixture f(world);
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector3d inwards = Eigen::Vector3d(0.21, 0.21, 0.21) - f.position(name_of(i));
    ASSERT_TRUE(f.physics.set_model_twist(f.id(name_of(i)),
                                          {3 * inwards + Eigen::Vector3d(number(random), number(random), number(random)), {0, 0, 0}}));
  }
  const double start = energy_of(f, count);
  for (int i = 0; i < 20; ++i) {
    f.run(0.05);
    ASSERT_LE(energy_of(f, count), 1.001 * start) << i;
  }
  EXPECT_GE(energy_of(f, count), 0.9 * start);
}

}  // namespace
}  // namespace sim

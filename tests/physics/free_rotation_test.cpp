// Bodies that tumble freely, beside Euler's equations.
#include <gtest/gtest.h>

#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;

// A thin plate of 1 kg without weight: three different moments of inertia.
ModelDef plate() {
  ModelDef model = body("plate", BoxShape{{0.6, 0.3, 0.02}}, at(0, 0, 2), 1);
  model.links[0].inertia = Eigen::Vector3d(0.3 * 0.3 + 0.02 * 0.02, 0.6 * 0.6 + 0.02 * 0.02, 0.6 * 0.6 + 0.3 * 0.3).asDiagonal();
  model.links[0].inertia /= 12;
  model.allow_auto_disable = false;
  return model;
}

struct Motion {
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d spin{0, 0, 0};  // in the body
};

// Euler's equations in the body, in steps of 10 us.
Motion exact(const Eigen::Vector3d& inertia, const Eigen::Vector3d& spin, double seconds) {
  constexpr double dt = 1e-5;
  const auto change = [&](const Eigen::Vector3d& w) { return Eigen::Vector3d(-w.cross(inertia.cwiseProduct(w)).cwiseQuotient(inertia)); };
  Motion motion{Eigen::Quaterniond::Identity(), spin};
  for (int i = 0; i < std::lround(seconds / dt); ++i) {
    Eigen::Vector3d& w = motion.spin;
    const Eigen::Vector3d a = change(w), b = change(w + 0.5 * dt * a), c = change(w + 0.5 * dt * b), d = change(w + dt * c);
    const Eigen::Vector3d turn = dt * (w + dt / 6 * (a + b + c));
    motion.orientation = (motion.orientation * Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized()))).normalized();
    w += dt / 6 * (a + 2 * b + 2 * c + d);
  }
  return motion;
}

// ODE's own gyroscopic torque lost 4.6 % of the energy in these ten seconds, and the phase with it.
TEST(FreeRotation, a_tumbling_plate_keeps_its_energy_momentum_and_phase) {
  WorldDef world = world_of({plate()});
  world.physics.gravity.setZero();
  PhysicsFixture f(world);
  const Eigen::Vector3d inertia = plate().links[0].inertia.diagonal(), spin(0.4, 5, 0.3);  // near the unstable axis
  ASSERT_TRUE(f.physics.set_model_twist(f.id("plate"), {{0, 0, 0}, spin}));
  const double energy = 0.5 * spin.dot(inertia.cwiseProduct(spin));
  f.run(10);
  const Eigen::Quaterniond orientation(f.physics.model_pose(f.id("plate")).linear());
  const Eigen::Vector3d now = f.physics.link_twist(f.link("plate::link")).angular;
  const Eigen::Vector3d in_body = orientation.conjugate() * now;
  EXPECT_NEAR(0.5 * in_body.dot(inertia.cwiseProduct(in_body)), energy, 1e-5 * energy);
  const Eigen::Vector3d momentum = orientation * inertia.cwiseProduct(in_body), first = inertia.cwiseProduct(spin);
  EXPECT_LT((momentum - first).norm(), 1e-9 * first.norm());
  const Motion expected = exact(inertia, spin, 10);
  EXPECT_LT(orientation.angularDistance(expected.orientation), 0.01);
  EXPECT_LT((in_body - expected.spin).norm(), 0.01);
}

TEST(FreeRotation, a_body_that_turns_about_an_axis_of_inertia_is_left_to_ode) {
  WorldDef world = world_of({plate()});
  world.physics.gravity.setZero();
  PhysicsFixture f(world);
  ASSERT_TRUE(f.physics.set_model_twist(f.id("plate"), {{0, 0, 0}, {0, 0, 3}}));
  f.run(2);
  const Eigen::Vector3d now = f.physics.link_twist(f.link("plate::link")).angular;
  EXPECT_LT((now - Eigen::Vector3d(0, 0, 3)).norm(), 1e-12);
}

TEST(FreeRotation, a_thrown_plate_falls_and_comes_to_rest) {
  PhysicsFixture f(world_of({ground(), plate()}));
  ASSERT_TRUE(f.physics.set_model_twist(f.id("plate"), {{0.5, 0, 1}, {1, 6, 2}}));
  f.run(6);
  EXPECT_NEAR(f.position("plate").z(), 0.01, 0.002);
  EXPECT_LT(f.physics.link_twist(f.link("plate::link")).angular.norm(), 0.05);
}

}  // namespace
}  // namespace sim

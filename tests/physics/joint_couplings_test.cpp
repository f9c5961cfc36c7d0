// Screws and gearboxes against the closed forms of mechanics.
#include <gtest/gtest.h>

#include <numbers>

#include "support/joint_rig.h"

namespace sim {
namespace {

using namespace test;

TEST(ScrewJoint, turns_and_travels_together_and_falls_slowed_by_its_inertia) {
  for (const double pitch : {0.2, -0.2, 0.02}) {
    PhysicsFixture f = make({.kind = "screw",
                             .axes = axis("0 0 1") + "<screw_thread_pitch>" + std::to_string(pitch) + "</screw_thread_pitch>",
                             .gravity = "0 0 -9.8"});
    EXPECT_TRUE(f.notes.empty());
    const double lead = pitch / (2 * std::numbers::pi), acceleration = -g / (1 + 0.04 / (lead * lead));
    f.run(2);
    const double fallen = f.physics.link_pose(f.link("m::arm")).translation().z() - 1;
    EXPECT_NEAR(fallen, acceleration * 2, std::abs(0.005 * acceleration * 2)) << pitch;
    EXPECT_NEAR(place_of(f), fallen / lead, 1e-9) << "with its whole turns";
    EXPECT_NEAR(f.physics.link_twist(f.link("m::arm")).angular.z() * lead, f.physics.link_twist(f.link("m::arm")).linear.z(), 2e-5)
        << pitch;
    const Eigen::Matrix3d turned = f.physics.link_pose(f.link("m::arm")).linear();
    EXPECT_NEAR(std::remainder(std::atan2(turned(1, 0), turned(0, 0)) - fallen / lead, 2 * std::numbers::pi), 0, 1e-3) << pitch;
  }
}

TEST(ScrewJoint, a_motor_drives_the_nut_along) {
  PhysicsFixture f = make({.kind = "screw", .axes = axis("1 0 0") + "<screw_thread_pitch>0.1</screw_thread_pitch>", .gravity = "0 0 -9.8"});
  f.physics.set_motor(f.joint("m", "j"), 0, 2 * std::numbers::pi, 5);
  f.run(3);
  EXPECT_NEAR(f.physics.link_pose(f.link("m::arm")).translation().x(), 0.3, 0.003);
  EXPECT_NEAR(place_of(f), 6 * std::numbers::pi, 0.1);
}

TEST(ScrewJoint, keeps_limits_of_many_turns_and_friction_and_damping) {
  PhysicsFixture f =
      make({.kind = "screw",
            .axes = axis("0 0 1", "<limit><lower>-10</lower><upper>20</upper></limit>") + "<screw_thread_pitch>0.1</screw_thread_pitch>"});
  f.physics.set_motor(f.joint("m", "j"), 0, 10, 1);
  f.run(4);
  EXPECT_NEAR(place_of(f), 20, 0.1);
  f.physics.set_motor(f.joint("m", "j"), 0, -10, 1);
  f.run(5);
  EXPECT_NEAR(place_of(f), -10, 0.1);
  PhysicsFixture held =
      make({.kind = "screw",
            .axes = axis("0 0 1", "<dynamics><friction>0.2</friction></dynamics>") + "<screw_thread_pitch>0.1</screw_thread_pitch>",
            .gravity = "0 0 -9.8"});
  held.run(1);
  EXPECT_NEAR(place_of(held), 0, 1e-6) << "9.8 N on a thread of 0.1 m are 0.156 N m";
  PhysicsFixture damped =
      make({.kind = "screw",
            .axes = axis("0 0 1", "<dynamics><damping>0.1</damping></dynamics>") + "<screw_thread_pitch>0.1</screw_thread_pitch>",
            .gravity = "0 0 -9.8"});
  damped.run(5);
  EXPECT_NEAR(rate_of(damped), -g * 0.1 / (2 * std::numbers::pi) / 0.1, 0.01);
}

TEST(ScrewJoint, between_free_bodies_conserves_momentum) {
  PhysicsFixture f = make({.kind = "screw", .axes = axis("0 0 1") + "<screw_thread_pitch>0.5</screw_thread_pitch>", .is_base_free = true});
  f.physics.set_motor(f.joint("m", "j"), 0, 3, 1);
  f.run(1);
  const Twist arm = f.physics.link_twist(f.link("m::arm")), base = f.physics.link_twist(f.link("m::base"));
  EXPECT_NEAR(arm.angular.z() - base.angular.z(), 3, 1e-4);
  EXPECT_NEAR(arm.linear.z() - base.linear.z(), 3 * 0.5 / (2 * std::numbers::pi), 1e-4);
  EXPECT_LT((arm.linear + 2 * base.linear).norm(), 1e-9);
  EXPECT_NEAR(0.04 * arm.angular.z() + 0.08 * base.angular.z(), 0, 1e-9);
}

// --- gearbox

struct Gears {
  Eigen::Vector3d place2{0.4, 0, 1};
  std::string axis2 = "0 0 1";
  double ratio = 2;
};

PhysicsFixture geared(const Gears& gears) {
  const auto n = [](double v) { return std::to_string(v); };
  return PhysicsFixture(world_of_text(
      "<gravity>0 0 0</gravity><model name='m'><allow_auto_disable>0</allow_auto_disable><link name='frame'/><link name='a'><pose>0 0 1 0 "
      "0 0</pose>" +
      inertial() + "</link><link name='b'><pose>" + n(gears.place2.x()) + " " + n(gears.place2.y()) + " " + n(gears.place2.z()) +
      " 0 0 0</pose>" + inertial() +
      "</link><joint name='held' type='fixed'><parent>world</parent><child>frame</child></joint><joint name='ja' "
      "type='revolute'><parent>frame</parent><child>a</child>" +
      axis("0 0 1") + "</joint><joint name='jb' type='continuous'><parent>frame</parent><child>b</child>" + axis(gears.axis2) +
      "</joint><joint name='j' "
      "type='gearbox'><parent>a</parent><child>b</child><gearbox_reference_body>frame</gearbox_reference_body><gearbox_ratio>" +
      n(gears.ratio) + "</gearbox_ratio>" + axis("0 0 1") + axis(gears.axis2, "", "axis2") + "</joint></model>"));
}

TEST(GearboxJoint, keeps_its_ratio_and_carries_torque_over) {
  for (const Gears& gears :
       {Gears{}, Gears{{0.4, 0, 1}, "0 0 1", -3}, Gears{{0.4, 0.1, 1.5}, "0 0 -1", 1}, Gears{{0.4, 0.3, 1.2}, "1 0 0", 2},
        Gears{{0.1, 0, 1}, "0 0.6 0.8", -0.5}, Gears{{0.2, 0, 1}, "0 0 1", -1}, Gears{{0, 0, 1.5}, "0 0 1", -1}}) {
    PhysicsFixture f = geared(gears);
    EXPECT_TRUE(f.notes.empty()) << f.notes.front();
    const double inertia2 = gears.axis2 == "1 0 0" ? 0.02 : gears.axis2 == "0 0.6 0.8" ? 0.36 * 0.03 + 0.64 * 0.04 : 0.04;
    const double torque = 0.05, acceleration = torque / (0.04 + inertia2 / (gears.ratio * gears.ratio));
    f.physics.set_motor(f.joint("m", "ja"), 0, 1000, torque);
    f.run(1);
    const double first = f.physics.joint_state(f.joint("m", "ja")).velocity, second = f.physics.joint_state(f.joint("m", "jb")).velocity;
    EXPECT_NEAR(first, acceleration, 0.002 * acceleration) << gears.axis2 << " " << gears.ratio;
    EXPECT_NEAR(first, -gears.ratio * second, 1e-6) << gears.axis2 << " " << gears.ratio;
    f.physics.set_motor(f.joint("m", "ja"), 0, 0, 0);
    f.run(20);
    EXPECT_NEAR(f.physics.joint_state(f.joint("m", "ja")).velocity, first, 5e-4 * std::abs(first)) << "no loss";
  }
  EXPECT_EQ(geared(Gears{{0, 0, 1.5}, "0 0 1", 2}).notes.size(), 1U) << "on one line";
}

}  // namespace
}  // namespace sim

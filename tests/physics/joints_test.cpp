// Every kind of joint against the closed forms of mechanics: motion, limits, friction, damping, springs, motors, places at the start.
#include <gtest/gtest.h>

#include "support/joint_rig.h"

namespace sim {
namespace {

using namespace test;

// --- revolute

TEST(RevoluteJoint, swings_with_the_period_of_a_physical_pendulum) {
  PhysicsFixture f = make({.axes = axis("0 1 0"), .center = "0 0 -0.5 0 0 0", .gravity = "0 0 -9.8"});
  spin(f, {0, 0.1, 0});
  // Half a swing between two passages of the lowest place.
  std::vector<double> passages;
  double before = place_of(f);
  for (int i = 1; i < 4000; ++i) {
    f.physics.step();
    const double now = place_of(f);
    if (before * now < 0) passages.push_back(0.001 * (i - now / (now - before)));
    before = now;
  }
  ASSERT_GE(passages.size(), 3U);
  const double period = 2 * std::numbers::pi * std::sqrt((0.03 + 0.25) / (g * 0.5));
  EXPECT_NEAR(passages[2] - passages[0], period, 0.002 * period);
}

TEST(RevoluteJoint, damping_is_an_exponential_with_and_without_limits) {
  for (const char* limits : {"", "<limit><lower>-3</lower><upper>3</upper></limit>"}) {
    PhysicsFixture f = make({.axes = axis("0 0 1", std::string(limits) + "<dynamics><damping>0.08</damping></dynamics>")});
    spin(f, {0, 0, 2});
    const double start = rate_of(f);
    f.run(0.5);
    EXPECT_NEAR(rate_of(f), start * std::exp(-0.08 / 0.04 * 0.5), 0.005) << limits;
  }
}

TEST(RevoluteJoint, friction_brakes_evenly_and_holds_in_the_end) {
  PhysicsFixture f = make({.axes = axis("0 0 1", "<dynamics><friction>0.04</friction></dynamics>")});
  spin(f, {0, 0, 2});
  const double start = rate_of(f);
  f.run(1);
  EXPECT_NEAR(rate_of(f), start - 1, 1e-3);
  f.run(2);
  EXPECT_NEAR(rate_of(f), 0, 1e-9);
  ASSERT_TRUE(f.physics.add_wrench(f.link("m::arm"), {0, 0, 0}, {0, 0, 0.039}));
  f.physics.step();
  EXPECT_NEAR(rate_of(f), 0, 1e-9) << "a torque below the friction moves nothing";
}

TEST(RevoluteJoint, stops_at_its_limits) {
  PhysicsFixture f = make({.axes = axis("0 0 1", "<limit><lower>-0.3</lower><upper>0.5</upper></limit>")});
  f.physics.set_motor(f.joint("m", "j"), 0, 2, 0.5);
  f.run(2);
  EXPECT_NEAR(place_of(f), 0.5, 0.01);
  f.physics.set_motor(f.joint("m", "j"), 0, -2, 0.5);
  f.run(2);
  EXPECT_NEAR(place_of(f), -0.3, 0.01);
}

TEST(RevoluteJoint, a_spring_turns_it_with_its_period_about_its_reference) {
  PhysicsFixture f =
      make({.axes = axis("0 0 1", "<dynamics><spring_reference>0.4</spring_reference><spring_stiffness>1</spring_stiffness></dynamics>")});
  double highest = 0;
  int at = 0;
  for (int i = 1; i < 1000; ++i) {
    f.physics.step();
    if (place_of(f) > highest) highest = place_of(f), at = i;
  }
  EXPECT_NEAR(highest, 0.8, 0.005);
  EXPECT_NEAR(at * 0.001, std::numbers::pi * std::sqrt(0.04 / 1), 0.005);
}

TEST(RevoluteJoint, a_motor_keeps_its_rate_within_its_torque) {
  PhysicsFixture f = make({.axes = axis("0 0 1")});
  f.physics.set_motor(f.joint("m", "j"), 0, 3, 0.08);
  f.run(0.5);
  EXPECT_NEAR(rate_of(f), 0.08 / 0.04 * 0.5, 0.005) << "speeding up";
  f.run(2);
  EXPECT_NEAR(rate_of(f), 3, 1e-6);
}

TEST(RevoluteJoint, a_motor_keeps_the_velocity_limit_of_its_joint) {
  const auto rate_with = [](const std::string& limit, double velocity) {
    PhysicsFixture f = make({.axes = axis("0 0 1", "<limit><velocity>" + limit + "</velocity><effort>1</effort></limit>")});
    f.physics.set_motor(f.joint("m", "j"), 0, velocity, 1);
    f.run(1);
    return rate_of(f);
  };
  EXPECT_NEAR(rate_with("2", 5), 2, 1e-6);
  EXPECT_NEAR(rate_with("2", -5), -2, 1e-6);
  EXPECT_NEAR(rate_with("2", 1.5), 1.5, 1e-6);
  EXPECT_NEAR(rate_with("0", 5), 5, 1e-6) << "0 means none";
}

TEST(RevoluteJoint, counts_the_same_way_whichever_end_is_the_world) {
  for (const bool is_base_parent : {true, false}) {
    PhysicsFixture f = make({.axes = axis("0 0 1"), .is_base_parent = is_base_parent});
    spin(f, {0, 0, 0.5});
    f.run(0.1);
    const double sense = is_base_parent ? 1 : -1;  // the child turns against the parent
    EXPECT_NEAR(rate_of(f), sense * 0.5, 1e-3);
    EXPECT_NEAR(place_of(f), sense * 0.05, 1e-3);
    f.physics.set_motor(f.joint("m", "j"), 0, 0.7, 10);
    f.run(0.1);
    EXPECT_NEAR(rate_of(f), 0.7, 1e-6) << "and its motor turns that way";
  }
}

TEST(RevoluteJoint, between_two_free_bodies_conserves_angular_momentum) {
  PhysicsFixture f = make({.axes = axis("0 0 1"), .is_base_free = true});
  f.physics.set_motor(f.joint("m", "j"), 0, 3, 1);
  f.run(1);
  EXPECT_NEAR(rate_of(f), 3, 1e-6);
  EXPECT_NEAR(0.04 * f.physics.link_twist(f.link("m::arm")).angular.z() + 0.08 * f.physics.link_twist(f.link("m::base")).angular.z(), 0,
              1e-9);
}

TEST(RevoluteJoint, a_resting_spring_gives_no_kick_after_a_long_sleep) {
  WorldDef world =
      world_of_text("<gravity>0 0 0</gravity><model name='m'><link name='arm'>" + inertial() +
                    "</link><joint name='j' type='revolute'><parent>world</parent><child>arm</child><axis><xyz>0 0 "
                    "1</xyz><dynamics><friction>1</friction>"
                    "<spring_reference>0.5</spring_reference><spring_stiffness>1</spring_stiffness></dynamics></axis></joint></model>");
  PhysicsFixture f(std::move(world));
  f.run(20);
  ASSERT_EQ(f.physics.statistics().awake, 0U) << "friction holds it";
  ASSERT_TRUE(f.physics.add_wrench(f.link("m::arm"), {0, 0, 0}, {0, 0, 1e-6}));
  f.physics.step();
  EXPECT_NEAR(f.physics.link_twist(f.link("m::arm")).angular.norm(), 0, 1e-6);
}

// --- the axis

TEST(JointAxis, is_in_the_joints_frame_unless_the_file_says_otherwise) {
  const auto axis_of = [](const JointRig& rig) {
    PhysicsFixture f = make(rig);
    f.physics.set_motor(f.joint("m", "j"), 0, 1, 10);
    f.run(0.01);
    return f.physics.link_twist(f.link("m::arm")).angular;
  };
  const std::string turned = "0 0 1 0 0 1.5707963267948966";
  EXPECT_LT((axis_of({.axes = axis("1 0 0"), .arm_pose = turned}) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-6);
  EXPECT_LT(
      (axis_of({.axes = "<axis><xyz expressed_in='__model__'>1 0 0</xyz></axis>", .arm_pose = turned}) - Eigen::Vector3d(1, 0, 0)).norm(),
      1e-6);
  EXPECT_LT((axis_of({.axes = "<axis><xyz expressed_in='base'>1 0 0</xyz></axis>", .arm_pose = turned}) - Eigen::Vector3d(1, 0, 0)).norm(),
            1e-6);
  EXPECT_LT((axis_of({.axes = axis("1 0 0"), .joint_pose = "0 0 0 0 0 -1.5707963267948966", .arm_pose = turned}) - Eigen::Vector3d(1, 0, 0))
                .norm(),
            1e-6);
  // Older files: an element of its own, and in version 1.4 the model's frame by default.
  EXPECT_LT((axis_of({.axes = axis("1 0 0", "<use_parent_model_frame>1</use_parent_model_frame>"), .arm_pose = turned, .version = "1.6"}) -
             Eigen::Vector3d(1, 0, 0))
                .norm(),
            1e-6);
  EXPECT_LT((axis_of({.axes = axis("1 0 0"), .arm_pose = turned, .version = "1.4"}) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-6);
  EXPECT_LT((axis_of({.axes = axis("1 0 0"), .arm_pose = turned, .version = "1.6"}) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-6);
}

// --- prismatic

TEST(PrismaticJoint, falls_as_gravity_along_its_axis_says) {
  PhysicsFixture f = make({.kind = "prismatic", .axes = axis("0.6 0 0.8"), .gravity = "0 0 -9.8"});
  f.run(1);
  EXPECT_NEAR(rate_of(f), -g * 0.8, 1e-6);
  EXPECT_NEAR(place_of(f), -g * 0.8 / 2, 0.01);
  EXPECT_NEAR(f.physics.link_pose(f.link("m::arm")).translation().x(), 0.6 * place_of(f), 1e-6);
}

TEST(PrismaticJoint, damping_has_a_terminal_velocity) {
  PhysicsFixture f = make({.kind = "prismatic", .axes = axis("0 0 1", "<dynamics><damping>5</damping></dynamics>"), .gravity = "0 0 -9.8"});
  f.run(0.2);
  EXPECT_NEAR(rate_of(f), -g / 5 * (1 - std::exp(-1.0)), 0.01);
  f.run(3);
  EXPECT_NEAR(rate_of(f), -g / 5, 1e-3);
}

TEST(PrismaticJoint, friction_takes_its_part_or_holds) {
  PhysicsFixture sliding =
      make({.kind = "prismatic", .axes = axis("0 0 1", "<dynamics><friction>4</friction></dynamics>"), .gravity = "0 0 -9.8"});
  sliding.run(1);
  EXPECT_NEAR(rate_of(sliding), -(g - 4), 1e-6);
  PhysicsFixture holding =
      make({.kind = "prismatic", .axes = axis("0 0 1", "<dynamics><friction>10</friction></dynamics>"), .gravity = "0 0 -9.8"});
  holding.run(1);
  EXPECT_NEAR(place_of(holding), 0, 1e-6);
}

TEST(PrismaticJoint, stops_at_hard_and_gives_at_soft_limits) {
  PhysicsFixture hard =
      make({.kind = "prismatic", .axes = axis("0 0 1", "<limit><lower>-0.4</lower><upper>1</upper></limit>"), .gravity = "0 0 -9.8"});
  hard.run(2);
  EXPECT_NEAR(place_of(hard), -0.4, 0.002);
  PhysicsFixture soft = make(
      {.kind = "prismatic",
       .axes = axis("0 0 1", "<limit><lower>-0.4</lower><upper>1</upper><stiffness>98</stiffness><dissipation>20</dissipation></limit>"),
       .gravity = "0 0 -9.8"});
  soft.run(4);
  EXPECT_NEAR(place_of(soft), -0.5, 0.002) << "9.8 N into a spring of 98 N/m";
}

// --- two axes

TEST(UniversalJoint, turns_about_its_two_axes_and_not_about_the_third) {
  for (const char* kind : {"universal", "revolute2"}) {
    for (const bool is_base_parent : {true, false}) {
      for (const int which : {0, 1}) {
        PhysicsFixture f = make({.kind = kind, .axes = axis("1 0 0") + axis("0 1 0", "", "axis2"), .is_base_parent = is_base_parent});
        f.physics.set_motor(f.joint("m", "j"), 0, which == 0 ? 1 : 0, 1e4);
        f.physics.set_motor(f.joint("m", "j"), 1, which == 1 ? 1 : 0, 1e4);
        f.run(0.2);
        const double sense = is_base_parent ? 1 : -1;
        const Eigen::Vector3d expected = sense * Eigen::Vector3d::Unit(which);
        EXPECT_LT((f.physics.link_twist(f.link("m::arm")).angular - expected).norm(), 1e-3) << kind << which << is_base_parent;
        EXPECT_NEAR(rate_of(f, which), 1, 1e-3) << kind << which << is_base_parent;
        EXPECT_NEAR(place_of(f, which), 0.2, 2e-3) << kind << which << is_base_parent;
        EXPECT_NEAR(place_of(f, 1 - which), 0, 1e-3) << kind << which << is_base_parent;
      }
      PhysicsFixture f = make({.kind = kind, .axes = axis("1 0 0") + axis("0 1 0", "", "axis2"), .is_base_parent = is_base_parent});
      spin(f, {0, 0, 1});
      f.run(0.1);
      EXPECT_LT(f.physics.link_twist(f.link("m::arm")).angular.norm(), 1e-6) << kind;
    }
  }
}

TEST(UniversalJoint, keeps_limits_friction_and_damping_of_each_axis) {
  for (const char* kind : {"universal", "revolute2"}) {
    PhysicsFixture f = make({.kind = kind,
                             .axes = axis("1 0 0", "<limit><lower>-0.2</lower><upper>0.6</upper></limit>") +
                                     axis("0 1 0", "<dynamics><damping>0.06</damping></dynamics>", "axis2")});
    f.physics.set_motor(f.joint("m", "j"), 0, 1, 1);
    f.run(2);
    EXPECT_NEAR(place_of(f, 0), 0.6, 0.01) << kind;
    f.physics.set_motor(f.joint("m", "j"), 0, -1, 1);
    f.run(2);
    EXPECT_NEAR(place_of(f, 0), -0.2, 0.01) << kind;
    PhysicsFixture damped = make({.kind = kind,
                                  .axes = axis("1 0 0", "<dynamics><friction>1</friction></dynamics>") +
                                          axis("0 1 0", "<dynamics><damping>0.06</damping></dynamics>", "axis2")});
    spin(damped, {0, 1, 0});
    const double start = rate_of(damped, 1);
    damped.run(0.25);
    EXPECT_NEAR(rate_of(damped, 1), start * std::exp(-0.06 / 0.03 * 0.25), 0.01) << kind;
    EXPECT_NEAR(place_of(damped, 0), 0, 1e-6) << kind;
  }
}

TEST(BallJoint, a_conical_pendulum_goes_round_in_its_time) {
  const double length = 0.5, angle = 0.4;
  PhysicsFixture f = make({.kind = "ball", .arm_pose = "0 0 1 0 -0.4 0", .center = "0 0 -0.5 0 0 0", .gravity = "0 0 -9.8"});
  // A body that goes round without turning about its own axis in it: L = I w; moments about the anchor for the tilted body.
  const Eigen::Matrix3d tilt = f.physics.link_pose(f.link("m::arm")).linear();
  const Eigen::Matrix3d inertia = tilt * Eigen::Vector3d(0.02 + 0.25, 0.03 + 0.25, 0.04).asDiagonal() * tilt.transpose();
  // Steady: w x (I w) = torque of gravity, w along z: w^2 (z x I z) = r x m g.
  const Eigen::Vector3d z(0, 0, 1), arm = tilt * Eigen::Vector3d(0, 0, -length);
  const Eigen::Vector3d torque = arm.cross(Eigen::Vector3d(0, 0, -g)), left = z.cross(inertia * z);
  const double rate = std::sqrt(torque.norm() / left.norm());
  EXPECT_GT(torque.dot(left), 0);
  ASSERT_TRUE(f.physics.set_model_twist(f.id("m"), {rate * z.cross(Eigen::Vector3d::Zero().eval()), {0, 0, rate}}));
  f.run(2 * std::numbers::pi / rate / 4);
  const Eigen::Vector3d now = f.physics.center_of_mass(f.link("m::arm")) - Eigen::Vector3d(0, 0, 1);
  const Eigen::Vector3d quarter = Eigen::AngleAxisd(std::numbers::pi / 2, z) * arm;
  EXPECT_LT((now - quarter).norm(), 0.01) << "angle " << angle;
}

TEST(FixedJoint, that_is_measured_holds_like_a_weld_and_tells_its_load) {
  PhysicsFixture f = make({.kind = "fixed", .arm_pose = "0.5 0 1 0 0 0", .gravity = "0 0 -9.8", .extra = ""});
  WorldDef world = *f.world;
  world.models[0].joints[1].provide_feedback = true;
  PhysicsFixture measured(world);
  measured.run(2);
  EXPECT_LT((measured.physics.link_pose(measured.link("m::arm")).translation() - Eigen::Vector3d(0.5, 0, 1)).norm(), 1e-4);
  const auto load = measured.physics.joint_load(measured.joint("m", "j"));
  ASSERT_TRUE(load.has_value());
  EXPECT_LT((load->force - Eigen::Vector3d(0, 0, g)).norm(), 1e-3);
  EXPECT_FALSE(f.physics.joint_load(f.joint("m", "j")).has_value());
}

// --- the start

TEST(InitialPosition, of_joints_moves_all_that_hangs_on_them) {
  PhysicsFixture f(world_of_text(
      "<gravity>0 0 0</gravity><model name='m'><link name='base'/><link name='upper'><pose>0 0 1 0 0 0</pose></link><link "
      "name='lower'><pose>1 0 1 0 0 0</pose></link>"
      "<link name='slide'><pose>1.5 0 1 0 0 0</pose></link><joint name='held' "
      "type='fixed'><parent>world</parent><child>base</child></joint>"
      "<joint name='shoulder' type='revolute'><parent>base</parent><child>upper</child>" +
          axis("0 0 1", "<initial_position>1.5707963267948966</initial_position><limit><lower>-2</lower><upper>2</upper></limit>") +
          "</joint><joint name='elbow' type='revolute'><parent>upper</parent><child>lower</child>" +
          axis("0 1 0", "<initial_position>-1.5707963267948966</initial_position>") +
          "</joint><joint name='rail' type='prismatic'><parent>lower</parent><child>slide</child>" +
          axis("1 0 0", "<initial_position>0.25</initial_position>") + "</joint></model>",
      "1.6"));
  const auto check = [&](const char* when) {
    EXPECT_LT((f.physics.link_pose(f.link("m::lower")).translation() - Eigen::Vector3d(0, 1, 1)).norm(), 1e-6) << when;
    EXPECT_LT((f.physics.link_pose(f.link("m::slide")).translation() - Eigen::Vector3d(0, 1, 1.75)).norm(), 1e-6) << when;
    EXPECT_NEAR(f.physics.joint_state(f.joint("m", "shoulder")).position, std::numbers::pi / 2, 1e-6) << when;
    EXPECT_NEAR(f.physics.joint_state(f.joint("m", "elbow")).position, -std::numbers::pi / 2, 1e-6) << when;
    EXPECT_NEAR(f.physics.joint_state(f.joint("m", "rail")).position, 0.25, 1e-6) << when;
  };
  check("at the start");
  f.run(1);
  check("at rest");
  f.physics.set_motor(f.joint("m", "shoulder"), 0, 3, 10);
  f.run(1);
  EXPECT_NEAR(f.physics.joint_state(f.joint("m", "shoulder")).position, 2, 0.01) << "limits count from zero, not from the start";
  f.physics.reset();
  check("after a reset");
}

TEST(SavedState, starts_a_bent_arm_where_it_was_and_as_fast_as_it_was) {
  // Level in the file, hanging down in the state, and swinging with 2 rad/s.
  PhysicsFixture f(world_of_text(
      "<model name='m'><pose>3 0 0 0 0 0</pose><link name='arm'><pose>0.5 0 2 0 0 0</pose>" + inertial() +
          "</link><joint name='pivot' type='revolute'><pose>-0.5 0 0 0 0 0</pose><parent>world</parent><child>arm</child>" + axis("0 1 0") +
          "</joint></model><state world_name='w'><model name='m'><pose>3 0 0 0 0 0</pose><link name='arm'><pose>3 0 1.5 0 "
          "1.5707963267948966 "
          "0</pose><velocity>-1 0 0 0 2 0</velocity></link></model></state>",
      "1.6"));
  const auto check = [&](const char* when) {
    EXPECT_NEAR(f.physics.joint_state(f.joint("m", "pivot")).position, std::numbers::pi / 2, 1e-6) << when;
    EXPECT_NEAR(f.physics.joint_state(f.joint("m", "pivot")).velocity, 2, 1e-6) << when;
    EXPECT_LT((f.physics.link_pose(f.link("m::arm")).translation() - Eigen::Vector3d(3, 0, 1.5)).norm(), 1e-6) << when;
  };
  check("at the start");
  double highest = 0;
  for (int i = 0; i < 1000; ++i) {
    f.physics.step();
    highest = std::max(highest, f.physics.link_pose(f.link("m::arm")).translation().z());
  }
  // Energy: (0.03 + 0.25) kg m^2 * (2 rad/s)^2 / 2 lifts 1 kg by 0.057 m.
  EXPECT_NEAR(highest - 1.5, 0.28 * 4 / 2 / g, 0.002);
  f.physics.reset();
  check("after a reset");
}

// Every way in which people tie a model to the world.
TEST(Joints, between_a_link_and_the_world_hold_in_every_spelling) {
  const std::string link = "<link name='arm'><pose>0 0 1 0 0 0</pose>" + inertial() + "</link>";
  const std::string hinge = axis("0 1 0");
  for (const auto& [version, model] : {
           std::pair<std::string, std::string>{"1.4",
                                               link + "<joint name='j' type='revolute'><parent>world</parent><child>arm</child>" + hinge},
           {"1.6", link + "<joint name='j' type='revolute'><pose>0 0 0 0 0 0</pose><child>arm</child><parent>world</parent>" + hinge},
           {"1.9", link + "<joint name='j' type='revolute'><parent>world</parent><child>arm</child>" + hinge},
           {"1.7", link + "<joint name='j' type='revolute'><pose relative_to='arm'/><parent>world</parent><child>arm</child>" + hinge},
           {"1.7",
            link + "<frame name='f' attached_to='arm'/><joint name='j' type='revolute'><parent>world</parent><child>f</child>" + hinge},
           {"1.8", "<model name='inner'>" + link +
                       "</model><joint name='j' type='revolute'><parent>world</parent><child>inner::arm</child>" + hinge},
       }) {
    PhysicsFixture f(world_of_text("<model name='m'><pose>2 0 0 0 0 0</pose>" + model + "</joint></model>", version));
    f.run(1);
    const std::string name = model.find("inner") != std::string::npos ? "m::inner::arm" : "m::arm";
    EXPECT_LT((f.physics.link_pose(f.link(name)).translation() - Eigen::Vector3d(2, 0, 1)).norm(), 1e-4) << version << " " << model;
    ASSERT_TRUE(f.physics.add_wrench(f.link(name), {0, 0, 0}, {0, 10, 0}));
    f.run(0.1);
    EXPECT_GT(f.physics.link_twist(f.link(name)).angular.y(), 0.1) << version << " " << model;
  }
}

}  // namespace
}  // namespace sim

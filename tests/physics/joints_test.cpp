// Every kind of joint against the closed forms of mechanics: motion, limits, friction, damping, springs, motors, places at the start.
#include <gtest/gtest.h>

#include "support/physics_fixture.h"

namespace sim {
namespace {

using namespace test;

constexpr double g = 9.8;

// A model whose link `arm` (1 kg, moments 0.02, 0.03, 0.04, no shape) hangs on `base`, which is welded to the world or free. The joint's
// frame is that of the arm, unless `pose` says otherwise.
struct Rig {
  std::string kind = "revolute";
  std::string axes{};        // <axis> and more
  std::string joint_pose{};  // in the arm
  std::string arm_pose = "0 0 1 0 0 0";
  std::string center{};  // of mass in the arm
  std::string gravity = "0 0 0";
  std::string extra{};  // links and joints
  bool is_base_free = false;
  bool is_base_parent = true;
  std::string version = "1.9";
};

std::string inertial(const std::string& center = "0 0 0 0 0 0", double mass = 1, double scale = 1) {
  const auto n = [&](double v) { return std::to_string(v * scale); };
  return "<inertial><pose>" + center + "</pose><mass>" + std::to_string(mass) + "</mass><inertia><ixx>" + n(0.02) + "</ixx><iyy>" +
         n(0.03) + "</iyy><izz>" + n(0.04) + "</izz></inertia></inertial>";
}

PhysicsFixture make(const Rig& rig) {
  const std::string base = rig.is_base_free ? "" : "<joint name='held' type='fixed'><parent>world</parent><child>base</child></joint>";
  const std::string parent = rig.is_base_parent ? "base" : "arm", child = rig.is_base_parent ? "arm" : "base";
  WorldDef world = world_of_text(
      "<gravity>" + rig.gravity + "</gravity><model name='m'><allow_auto_disable>false</allow_auto_disable><link name='base'>" +
          inertial("0 0 0 0 0 0", 2, 2) + "</link><link name='arm'><pose>" + rig.arm_pose + "</pose>" +
          inertial(rig.center.empty() ? "0 0 0 0 0 0" : rig.center) + "</link>" + base + "<joint name='j' type='" + rig.kind + "'>" +
          (rig.joint_pose.empty() ? "" : "<pose>" + rig.joint_pose + "</pose>") + "<parent>" + parent + "</parent><child>" + child +
          "</child>" + rig.axes + "</joint>" + rig.extra + "</model>",
      rig.version);
  return PhysicsFixture(std::move(world));
}

std::string axis(const std::string& xyz, const std::string& more = "", const std::string& name = "axis") {
  return "<" + name + "><xyz>" + xyz + "</xyz>" + more + "</" + name + ">";
}

void spin(PhysicsFixture& f, const Eigen::Vector3d& rate, const std::string& link = "m::arm") {
  const Eigen::Vector3d moments(0.02, 0.03, 0.04);
  ASSERT_TRUE(f.physics.add_wrench(f.link(link), {0, 0, 0}, moments.cwiseProduct(rate) / f.physics.step_length()));
  f.physics.step();
}

double rate_of(const PhysicsFixture& f, int axis = 0) { return f.physics.joint_state(f.joint("m", "j"), axis).velocity; }
double place_of(const PhysicsFixture& f, int axis = 0) { return f.physics.joint_state(f.joint("m", "j"), axis).position; }

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

// --- limits beyond half a turn

std::string limits(double low, double high) {
  return "<limit><lower>" + std::to_string(low) + "</lower><upper>" + std::to_string(high) + "</upper></limit>";
}

// Turns it with `rate` until it has gone `way` and a little more; the rate must stay until then.
void expect_even_way(PhysicsFixture& f, double rate, double way, const std::string& what, int axis = 0) {
  const double start = place_of(f, axis), sense = rate < 0 ? -1 : 1;
  double before = start;
  while (sense * (before - start) < way - 0.02) {
    f.physics.step();
    const double now = place_of(f, axis);
    ASSERT_NEAR(rate_of(f, axis), rate, 1e-3 * std::abs(rate)) << what << ", at " << now;
    ASSERT_NEAR(now - before, rate * f.physics.step_length(), 1e-4 * std::abs(rate)) << what << ", at " << now;
    before = now;
  }
}

TEST(WideLimits, let_a_joint_turn_on_until_it_stops_there) {
  struct Case {
    double low, high;
  };
  constexpr double degree = std::numbers::pi / 180;
  for (const auto& [low, high] : {Case{-0.02, 3.75}, Case{-3.75, 0.02}, Case{-360 * degree, 360 * degree},
                                  Case{-255 * degree, 255 * degree}, Case{-270 * degree, 270 * degree}, Case{-3.2, 3.1}, Case{-3.14, 3.14},
                                  Case{-180 * degree, 180 * degree}, Case{-3 * std::numbers::pi, std::numbers::pi}, Case{-20, 30}}) {
    for (const bool is_base_parent : {true, false}) {
      for (const bool goes_up : {true, false}) {
        const std::string what = std::to_string(low) + " to " + std::to_string(high) + (goes_up ? ", up" : ", down");
        PhysicsFixture f = make({.axes = axis("0 0 1", limits(low, high)), .is_base_parent = is_base_parent});
        EXPECT_TRUE(f.notes.empty()) << f.notes.front();
        const double rate = goes_up ? 1 : -1, end = goes_up ? high : low;
        spin(f, {0, 0, is_base_parent ? rate : -rate});
        expect_even_way(f, rate, std::abs(end), what);
        double most = 0;
        for (int i = 0; i < 1000; ++i) f.physics.step(), most = std::max(most, std::abs(rate_of(f)));
        EXPECT_LT(most, 1.01) << what;
        EXPECT_NEAR(place_of(f), end, 0.001) << what;
        EXPECT_NEAR(rate_of(f), 0, 0.2) << what << ": it does not jump back";
        spin(f, {0, 0, is_base_parent ? -rate : rate});
        expect_even_way(f, rate_of(f), 0.5 * (high - low), what + ", and back");
      }
    }
  }
}

TEST(WideLimits, hold_however_fast_a_joint_comes) {
  for (const double rate : {30.0, 300.0, 3000.0}) {
    for (const double high : {3.1, 3.2, 9.0}) {
      PhysicsFixture f = make({.axes = axis("0 0 1", limits(-0.02, high))});
      spin(f, {0, 0, rate});
      double most = 0;
      for (int i = 0; i < 1000; ++i) f.physics.step(), most = std::max(most, std::abs(rate_of(f)));
      EXPECT_LT(most, 1.001 * rate) << high;
      EXPECT_LT(place_of(f), high + 0.01) << rate;
      EXPECT_GT(place_of(f), -0.03) << rate;
    }
  }
}

TEST(WideLimits, hold_on_each_axis_of_a_joint_with_two) {
  for (const char* kind : {"universal", "revolute2"}) {
    for (const bool is_base_parent : {true, false}) {
      for (const int which : {0, 1}) {
        PhysicsFixture f = make({.kind = kind,
                                 .axes = axis("1 0 0", limits(-0.02, 3.75)) + axis("0 1 0", limits(-0.5, 7), "axis2"),
                                 .is_base_parent = is_base_parent});
        f.physics.set_motor(f.joint("m", "j"), which, 1, 1);
        f.physics.set_motor(f.joint("m", "j"), 1 - which, 0, 1000);
        f.run(9);
        EXPECT_NEAR(place_of(f, which), which == 0 ? 3.75 : 7, 0.01) << kind;
        EXPECT_NEAR(rate_of(f, which), 0, 0.01) << kind;
        EXPECT_NEAR(place_of(f, 1 - which), 0, 0.01) << kind;
      }
    }
  }
}

TEST(WideLimits, hold_for_a_screw_without_a_thread) {
  PhysicsFixture f =
      make({.kind = "screw",
            .axes = axis("0 0 1", limits(-0.02, 3.75)) + "<screw_thread_pitch>0</screw_thread_pitch><thread_pitch>0</thread_pitch>"});
  spin(f, {0, 0, 1});
  f.run(5);
  EXPECT_NEAR(place_of(f), 3.75, 0.001);
}

TEST(WideLimits, count_from_the_initial_position) {
  const auto at_start = [](const std::string& initial, double low, double high) {
    return make({.axes = axis("0 0 1", "<initial_position>" + initial + "</initial_position>" + limits(low, high)), .version = "1.6"});
  };
  PhysicsFixture f = at_start("4", -0.02, 5);
  EXPECT_NEAR(place_of(f), 4, 1e-9);
  spin(f, {0, 0, 1});
  f.run(2);
  EXPECT_NEAR(place_of(f), 5, 0.001);
  f.physics.reset();
  EXPECT_NEAR(place_of(f), 4, 1e-9);
  PhysicsFixture turned = at_start("-14", -20, 0);
  spin(turned, {0, 0, -1});
  turned.run(7);
  EXPECT_NEAR(place_of(turned), -20, 0.001);
}

// A joint that the file has beyond its limits is not thrown into them.
TEST(WideLimits, that_a_joint_starts_beyond_let_it_in_and_not_further_out) {
  for (const double sense : {1.0, -1.0}) {
    for (const double way : {5.4, 2.5}) {
      const auto axes = axis("0 0 1", sense > 0 ? limits(0.5, way) : limits(-way, -0.5));
      PhysicsFixture resting = make({.axes = axes});
      resting.run(1);
      EXPECT_NEAR(rate_of(resting), sense * 0.01, 1e-3) << "slowly";
      EXPECT_NEAR(place_of(resting), sense * 0.01, 1e-3);
      PhysicsFixture f = make({.axes = axes});
      spin(f, {0, 0, -sense});
      f.run(0.2);
      EXPECT_NEAR(place_of(f), 0, 0.002) << "not further out";
      spin(f, {0, 0, sense});
      expect_even_way(f, rate_of(f), way, "in");
      f.run(0.2);
      EXPECT_NEAR(place_of(f), sense * way, 0.001);
      spin(f, {0, 0, -sense});
      f.run(way);
      EXPECT_NEAR(place_of(f), sense * 0.5, 0.001) << "once it was within it stays";
    }
  }
}

TEST(WideLimits, that_are_one_place_bring_a_joint_there_slowly) {
  for (const double place : {0.5, -4.0}) {
    PhysicsFixture f = make({.axes = axis("0 0 1", limits(place, place))});
    double most = 0;
    for (int i = 0; i < 6000; ++i) f.physics.step(), most = std::max(most, std::abs(rate_of(f)));
    EXPECT_LT(most, 1.01);
    EXPECT_NEAR(place_of(f), place, 1e-6);
  }
}

TEST(WideLimits, are_part_of_the_state_and_start_anew_with_it) {
  PhysicsFixture f = make({.axes = axis("0 0 1", limits(-20, 30))});
  const auto start = f.hash();
  spin(f, {0, 0, 1});
  f.run(7);
  const auto later = f.hash();
  EXPECT_NEAR(place_of(f), 7, 0.01);
  f.physics.reset();
  EXPECT_EQ(f.hash(), start);
  EXPECT_NEAR(place_of(f), 0, 1e-9);
  spin(f, {0, 0, 1});
  f.run(7);
  EXPECT_EQ(f.hash(), later);
  ASSERT_TRUE(f.physics.set_model_pose(0, Eigen::Isometry3d(Eigen::Translation3d(1, 0, 0))));
  f.run(0.1);
  EXPECT_NEAR(place_of(f), 0, 1e-6) << "what the world holds is built anew";
}

TEST(WideLimits, stay_with_a_free_arm_that_is_put_elsewhere) {
  PhysicsFixture f = make({.axes = axis("0 0 1", limits(-0.02, 3.75)), .is_base_free = true});
  f.physics.set_motor(f.joint("m", "j"), 0, 1, 10);
  f.run(3.5);
  ASSERT_NEAR(place_of(f), 3.5, 0.01);
  ASSERT_TRUE(f.physics.set_model_pose(0, Eigen::Isometry3d(Eigen::Translation3d(3, 0, 5))));
  EXPECT_NEAR(place_of(f), 3.5, 0.01);
  f.run(0.5);
  EXPECT_NEAR(place_of(f), 3.75, 0.01);
}

// Models that come near each other move into one ODE world.
TEST(WideLimits, stay_with_an_arm_that_is_built_anew_beside_others) {
  WorldDef world;
  world.physics.gravity.setZero();
  for (int i = 0; i < 8; ++i) {
    ModelDef other = body("other" + std::to_string(i), SphereShape{0.1}, at(20.0 * (i + 1), 0, 0));
    other.allow_auto_disable = false;
    world.models.push_back(other);
  }
  ModelDef arm = make({.axes = axis("0 0 1", limits(-0.02, 3.75)), .is_base_free = true}).world->models[0];
  for (auto& link : arm.links) link.collisions.push_back(body("x", SphereShape{0.1}, at(0, 0, 0)).links[0].collisions[0]);
  world.models.push_back(arm);
  PhysicsFixture f(std::move(world));
  f.physics.set_motor(f.joint("m", "j"), 0, 1, 10);
  f.run(3.5);
  ASSERT_NEAR(place_of(f), 3.5, 0.01);
  const auto moves = f.physics.statistics().moves_between_shards;
  for (int i = 0; i < 8 && f.physics.statistics().moves_between_shards == moves; ++i) {
    ASSERT_TRUE(f.physics.set_model_pose(f.id("other" + std::to_string(i)), at(0.5, 0, 0)));
  }
  ASSERT_GT(f.physics.statistics().moves_between_shards, moves);
  EXPECT_NEAR(place_of(f), 3.5, 0.01);
  f.run(0.2);
  EXPECT_NEAR(place_of(f), 3.7, 0.01);
  f.run(0.3);
  EXPECT_NEAR(place_of(f), 3.75, 0.01);
}

TEST(RevoluteJoint, a_spring_keeps_its_energy_beyond_half_a_turn) {
  PhysicsFixture f =
      make({.axes = axis("0 0 1", "<dynamics><spring_reference>2.5</spring_reference><spring_stiffness>1</spring_stiffness></dynamics>")});
  double highest = 0;
  for (int i = 1; i < 2000; ++i) f.physics.step(), highest = std::max(highest, place_of(f));
  EXPECT_NEAR(highest, 5, 0.02);
}

// --- the axis

TEST(JointAxis, is_in_the_joints_frame_unless_the_file_says_otherwise) {
  const auto axis_of = [](const Rig& rig) {
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

// --- screw

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

PhysicsFixture make(const Gears& gears) {
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
    PhysicsFixture f = make(gears);
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
  EXPECT_EQ(make(Gears{{0, 0, 1.5}, "0 0 1", 2}).notes.size(), 1U) << "on one line";
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

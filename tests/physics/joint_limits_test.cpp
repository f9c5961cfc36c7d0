// Limits of joints beyond half a turn: how far a joint turns, where it stops, what belongs to the state.
#include <gtest/gtest.h>

#include <numbers>

#include "support/joint_rig.h"

namespace sim {
namespace {

using namespace test;

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

}  // namespace
}  // namespace sim

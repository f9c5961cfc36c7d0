// The moving world against what mechanics says, and against itself: repeatable to the bit.
#include "physics/physics.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <numbers>
#include <thread>

#include "support/worlds.h"

namespace sim {
namespace {

using namespace test;

struct Fixture {
  explicit Fixture(WorldDef def, int threads = 1)
      : pool(threads, WorkerPool::Sharing::always),
        world(std::make_shared<const WorldDef>(std::move(def))),
        physics(world, pool, triangles, notes, dropped) {}
  void run(double seconds) {
    const auto steps = static_cast<int>(std::lround(seconds / physics.step_length()));
    for (int i = 0; i < steps; ++i) physics.step();
  }
  ModelId id(std::string_view name) const { return *physics.find(name); }
  Eigen::Vector3d position(std::string_view name) const { return physics.model_pose(id(name)).translation(); }
  std::uint64_t hash() const {
    StateHash hash;
    physics.add_to(hash);
    return hash.value();
  }
  WorkerPool pool;
  TriangleCache triangles;
  std::vector<std::string> notes, dropped;
  std::shared_ptr<const WorldDef> world;
  Physics physics;
};

WorldDef world_of(std::vector<ModelDef> models, double step = 0.001) {
  WorldDef world;
  world.physics.step = step;
  world.models = std::move(models);
  return world;
}

void drive(Physics& physics, ModelId robot, double left, double right) {
  physics.set_motor({robot, 0}, 0, left, 1.5);
  physics.set_motor({robot, 1}, 0, right, 1.5);
}

TEST(Physics, a_body_falls_as_gravity_says) {
  Fixture f(world_of({body("box", BoxShape{}, at(0, 0, 100))}));
  f.run(1);
  EXPECT_NEAR(f.position("box").z(), 100 - 9.8 / 2, 0.01);
  EXPECT_NEAR(f.physics.link_twist({0, 0}).linear.z(), -9.8, 1e-6);
}

TEST(Physics, a_box_on_a_plane_stays_and_falls_asleep) {
  Fixture f(world_of({ground(), body("box", BoxShape{{0.4, 0.4, 0.4}}, at(1, 2, 0.2))}));
  f.run(5);
  EXPECT_NEAR((f.position("box") - Eigen::Vector3d(1, 2, 0.2)).norm(), 0, 0.002);
  EXPECT_EQ(f.physics.statistics().awake, 0U);
}

TEST(Physics, a_stack_of_ten_boxes_stands_for_a_minute) {
  std::vector<ModelDef> models{ground()};
  for (int i = 0; i < 10; ++i) models.push_back(body("box" + std::to_string(i), BoxShape{{0.5, 0.5, 0.5}}, at(0, 0, 0.25 + 0.5 * i)));
  Fixture f(world_of(std::move(models)));
  f.run(60);
  for (int i = 0; i < 10; ++i) {
    const auto p = f.position("box" + std::to_string(i));
    EXPECT_LT(p.head<2>().norm(), 0.02) << i;
    EXPECT_NEAR(p.z(), 0.25 + 0.5 * i, 0.02) << i;
  }
}

TEST(Physics, a_frictionless_pendulum_keeps_its_energy) {
  ModelDef pendulum = body("pendulum", SphereShape{0.1}, at(0, 0, 2));
  pendulum.links[0].pose = at(1, 0, 0);
  JointDef hinge;
  hinge.name = "hinge";
  hinge.kind = JointDef::Kind::continuous;
  hinge.child = "link";
  AxisDef axis;
  axis.xyz = {0, 1, 0};
  hinge.axes = {axis};
  pendulum.joints = {hinge};
  pendulum.allow_auto_disable = false;
  Fixture f(world_of({pendulum}));
  const auto energy = [&] {
    const Twist twist = f.physics.link_twist({0, 0});
    return 0.5 * twist.linear.squaredNorm() + 0.5 * 0.4 * 0.01 * twist.angular.squaredNorm() +
           9.8 * f.physics.link_pose({0, 0}).translation().z();
  };
  const double before = energy(), range = 9.8;  // it swings a metre down from the height of the hinge
  f.run(60);
  EXPECT_NEAR(energy(), before, 0.01 * range);
  EXPECT_NEAR((f.physics.link_pose({0, 0}).translation() - Eigen::Vector3d(0, 0, 2)).norm(), 1, 0.001);
}

TEST(Physics, a_robot_drives_straight_at_the_speed_of_its_wheels) {
  Fixture f(world_of({ground(), pioneer("robot", at(0, 0, 0))}));
  drive(f.physics, 1, 0.3 / 0.0825, 0.3 / 0.0825);
  f.run(10);
  EXPECT_NEAR(f.position("robot").x(), 3, 0.06);
  EXPECT_NEAR(f.position("robot").y(), 0, 0.02);
}

TEST(Physics, a_braked_robot_does_not_slide_on_a_slope_of_ten_degrees) {
  const double slope = 10 * std::numbers::pi / 180;
  ModelDef robot = pioneer("robot", tilted(0, 0, 0, 0, slope));
  Fixture f(world_of({fixed("slope", PlaneShape{}, tilted(0, 0, 0, 0, slope)), robot}));
  drive(f.physics, 1, 0, 0);
  f.run(1);
  const auto settled = f.position("robot");
  f.run(20);
  EXPECT_LT((f.position("robot") - settled).norm(), 0.005);
}

TEST(Physics, ten_robots_drive_ten_minutes_and_none_sinks_tips_or_flies) {
  std::vector<ModelDef> models{ground()};
  for (int i = 0; i < 10; ++i) models.push_back(pioneer("robot" + std::to_string(i), at(2.0 * (i % 5), 2.0 * (i / 5), 0, i)));
  for (int i = 0; i < 4; ++i) {
    models.push_back(fixed(
        "wall" + std::to_string(i), BoxShape{{16, 0.2, 1}},
        at(4 + 8 * std::cos(i * std::numbers::pi / 2), 1 + 8 * std::sin(i * std::numbers::pi / 2), 0.5, (i + 1) * std::numbers::pi / 2)));
  }
  Fixture f(world_of(std::move(models), 0.005));
  for (int tenth = 0; tenth < 6000; ++tenth) {
    for (ModelId i = 1; i <= 10; ++i) {
      // Who bumps into something backs off, as a driver would.
      const auto contacts = f.physics.contacts(i);
      const bool bumped = std::any_of(contacts.begin(), contacts.end(), [](const Contact& contact) { return contact.other.model != 0; });
      const double turn = std::sin(tenth * 0.01 * i), speed = bumped ? -3 : 4;
      drive(f.physics, i, speed - turn, speed + turn);
    }
    f.run(0.1);
    for (ModelId i = 1; i <= 10; ++i) {
      const auto pose = f.physics.model_pose(i);
      ASSERT_NEAR(pose.translation().z(), 0, 0.02) << f.physics.def(i).name << " at " << tenth;
      // Who is bumped from behind may put its nose on the floor, at 25 degrees.
      ASSERT_GT(pose.linear()(2, 2), 0.85) << f.physics.def(i).name << " at " << tenth;
    }
  }
  EXPECT_TRUE(f.physics.take_complaints().empty());
}

WorldDef crowd() {
  std::vector<ModelDef> models{ground()};
  for (int i = 0; i < 12; ++i) models.push_back(pioneer("robot" + std::to_string(i), at(1.2 * (i % 4), 1.2 * (i / 4), 0, 0.7 * i)));
  models.push_back(body("ball", SphereShape{0.2}, at(1.8, 0.6, 0.5)));
  models.push_back(fixed("post", CylinderShape{0.2, 1}, at(0.6, 1.8, 0.5)));
  return world_of(std::move(models), 0.002);
}

void drive_crowd(Fixture& f, double seconds) {
  for (double t = 0; t < seconds; t += 0.5) {
    for (ModelId i = 1; i <= 12; ++i) drive(f.physics, i, 3 + std::sin(t + i), 3 - std::cos(t * i));
    f.run(0.5);
  }
}

TEST(Physics, the_run_does_not_depend_on_the_number_of_threads) {
  Fixture one(crowd(), 1), two(crowd(), 2), three(crowd(), 3);
  for (auto* f : {&one, &two, &three}) drive_crowd(*f, 20);
  EXPECT_GT(one.physics.statistics().shards, 1U);
  EXPECT_GT(one.physics.statistics().moves_between_shards, 0U);
  EXPECT_EQ(one.hash(), two.hash());
  EXPECT_EQ(one.hash(), three.hash());
}

// Waking a thread takes longer than short work; each part of a step of ten robots is short.
TEST(WorkerPool, shares_work_while_that_is_worth_it) {
  WorkerPool pool(2);
  WorkerPool::Pace pace;
  const auto run_until = [&](bool is_shared, const auto& part) {
    for (int i = 0; i < 100'000 && pace.is_shared != is_shared; ++i) pool.run(4, part, pace);
    return pace.is_shared == is_shared;
  };
  std::atomic<int> done{0};
  const auto long_part = [&](std::size_t) {
    ++done;
    const auto end = std::chrono::steady_clock::now() + std::chrono::microseconds(200);
    while (std::chrono::steady_clock::now() < end) {
    }
  };
  EXPECT_TRUE(run_until(true, long_part));
  done = 0;
  pool.run(4, long_part, pace);
  EXPECT_EQ(done, 4);
  const auto caller = std::this_thread::get_id();
  EXPECT_TRUE(run_until(false, [&](std::size_t) { ++done; }));
  bool is_alone = true;
  pool.run(
      4, [&](std::size_t) { is_alone = is_alone && std::this_thread::get_id() == caller; }, pace);
  EXPECT_TRUE(is_alone);
}

TEST(Physics, a_run_after_a_reset_is_the_same_to_the_bit) {
  Fixture f(crowd());
  drive_crowd(f, 10);
  const auto first = f.hash();
  f.physics.reset();
  drive_crowd(f, 10);
  EXPECT_EQ(f.hash(), first);
}

TEST(Physics, links_with_fixed_joints_are_one_body) {
  ModelDef model = body("m", BoxShape{{0.2, 0.2, 0.2}}, at(0, 0, 1));
  model.links.push_back(link("arm", BoxShape{{0.2, 0.2, 0.2}}, 3, at(1, 0, 0)));
  JointDef weld;
  weld.name = "weld";
  weld.parent = "link";
  weld.child = "arm";
  model.joints.push_back(weld);
  Fixture f(world_of({model}));
  EXPECT_EQ(f.physics.statistics().bodies, 1U);
  EXPECT_NEAR(f.physics.center_of_mass({0, 0}).x(), 0.75, 1e-9);
  f.run(0.5);
  EXPECT_NEAR((f.physics.link_pose({0, 1}).translation() - f.physics.link_pose({0, 0}).translation() - Eigen::Vector3d(1, 0, 0)).norm(), 0,
              1e-9);
}

TEST(Physics, a_ball_bounces_as_high_as_its_restitution_says) {
  ModelDef ball = body("ball", SphereShape{0.1}, at(0, 0, 1.1));
  ModelDef floor = ground();
  ball.links[0].collisions[0].surface.restitution = 0.5;
  ball.links[0].collisions[0].surface.bounce_threshold = 0.01;
  Fixture f(world_of({floor, ball}));
  double highest = 0;
  bool rising = false;
  for (int i = 0; i < 1500; ++i) {
    f.physics.step();
    rising = rising || f.physics.link_twist({1, 0}).linear.z() > 0.1;
    if (rising) highest = std::max(highest, f.position("ball").z());
  }
  EXPECT_NEAR(highest - 0.1, 0.25, 0.02);
}

TEST(Physics, a_ball_without_restitution_stays_where_it_falls) {
  for (const double height : {1.0, 0.37, 4.0}) {
    for (const double step : {0.001, 0.002, 0.0005}) {
      Fixture f(world_of({ground(), body("ball", SphereShape{0.1}, at(0, 0, 0.1 + height))}, step));
      while (f.position("ball").z() > 0.1) f.physics.step();
      double highest = 0;
      for (int i = 0; i < 1000; ++i) f.physics.step(), highest = std::max(highest, f.position("ball").z());
      EXPECT_LT(highest - 0.1, 0.001) << height << " m, " << step << " s";
      EXPECT_NEAR(f.position("ball").z(), 0.1, 1e-3);
    }
  }
}

TEST(Physics, numbers_that_are_not_finite_are_refused) {
  Fixture f(world_of({ground(), pioneer("robot", at(0, 0, 0))}));
  const auto before = f.hash();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(f.physics.set_model_pose(1, at(nan, 0, 0)));
  EXPECT_FALSE(f.physics.set_model_twist(1, {{infinite, 0, 0}, {0, 0, 0}}));
  EXPECT_FALSE(f.physics.set_model_twist(1, {{1e308, 0, 0}, {0, 0, 0}}));
  EXPECT_FALSE(f.physics.add_wrench({1, 0}, {0, nan, 0}, {0, 0, 0}));
  f.physics.set_motor({1, 0}, 0, nan, 5);
  ModelDef bad = body("bad", BoxShape{{1, -1, 1}}, at(0, 0, 5));
  std::vector<std::string> notes;
  EXPECT_FALSE(f.physics.spawn(std::make_shared<const ModelDef>(bad), notes));
  EXPECT_FALSE(f.physics.spawn(std::make_shared<const ModelDef>(pioneer("robot", at(3, 0, 0))), notes)) << "the name is taken";
  EXPECT_EQ(f.hash(), before);
}

TEST(Physics, tells_once_of_a_model_that_leaves_the_numbers_again_and_again) {
  Fixture f(world_of({ground(), body("dust", SphereShape{0.1}, at(0, 0, 5), 0.001)}));
  std::vector<std::string> lines;
  for (int i = 0; i < 200; ++i) {
    ASSERT_TRUE(f.physics.add_wrench({f.id("dust"), 0}, {1e7, 0, 0}, {0, 0, 0}));
    f.physics.step();
    for (const auto& line : f.physics.take_complaints()) lines.push_back(line);
  }
  f.run(3);
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(f.physics.add_wrench({f.id("dust"), 0}, {1e7, 0, 0}, {0, 0, 0}));
    f.run(3);
    for (const auto& line : f.physics.take_complaints()) lines.push_back(line);
  }
  EXPECT_EQ(lines, std::vector<std::string>{"model dust: left the range of numbers and was put back to where it started"});
}

TEST(Physics, what_is_spawned_moves_and_what_is_deleted_is_gone_until_a_reset) {
  Fixture f(world_of({ground(), body("shelf", BoxShape{}, at(0, 0, 0.5)), body("cup", SphereShape{0.1}, at(0, 0, 1.1))}));
  f.run(2);
  std::vector<std::string> notes;
  const auto spawned = f.physics.spawn(std::make_shared<const ModelDef>(body("late", SphereShape{0.1}, at(5, 0, 2))), notes);
  ASSERT_TRUE(spawned);
  f.physics.remove(f.id("shelf"));
  f.run(2);
  EXPECT_NEAR(f.position("late").z(), 0.1, 0.01);
  EXPECT_NEAR(f.position("cup").z(), 0.1, 0.01) << "what the cup stood on is gone";
  f.physics.reset();
  EXPECT_FALSE(f.physics.find("late"));
  EXPECT_TRUE(f.physics.find("shelf"));
}

TEST(Physics, contact_forces_carry_the_weight) {
  Fixture f(world_of({ground(), body("box", BoxShape{}, at(0, 0, 0.5), 10)}));
  f.physics.record_forces(1);
  f.run(0.3);
  double up = 0;
  for (const auto& contact : f.physics.contacts(1)) {
    up += contact.force.z();
    EXPECT_GT(contact.normal.z(), 0.99);
  }
  EXPECT_NEAR(up, 98, 0.5);
}

TEST(Physics, a_table_on_four_feet_loads_all_of_them_alike) {
  ModelDef table = body("table", SphereShape{0.05}, at(0, 0, 0.05, 0.3), 40);
  table.links[0].inertia = Eigen::Vector3d(4, 4, 4).asDiagonal();
  table.links[0].collisions.clear();
  for (const auto& [x, y] : {std::pair{0.4, 0.3}, {0.4, -0.3}, {-0.4, 0.3}, {-0.4, -0.3}}) {
    CollisionDef foot;
    foot.name = "foot";
    foot.geometry = SphereShape{0.05};
    foot.pose = at(x, y, 0);
    table.links[0].collisions.push_back(foot);
  }
  Fixture f(world_of({ground(), table}));
  f.physics.record_forces(1);
  f.run(0.3);
  ASSERT_EQ(f.physics.contacts(1).size(), 4U);
  for (const auto& contact : f.physics.contacts(1)) EXPECT_NEAR(contact.force.z(), 98, 1);
}

// Coulomb: it comes to rest after v^2 / (2 mu g), on the line that it was pushed along.
TEST(Physics, a_box_slides_as_far_in_every_direction) {
  for (const double heading : {0.0, 0.3, std::numbers::pi / 4, 2.0}) {
    ModelDef box = body("box", BoxShape{{0.5, 0.5, 0.1}}, at(0, 0, 0.05));
    box.links[0].collisions[0].surface.mu = box.links[0].collisions[0].surface.mu2 = 0.5;
    Fixture f(world_of({ground(), box}));
    f.run(0.1);
    ASSERT_TRUE(f.physics.set_model_twist(1, {{2 * std::cos(heading), 2 * std::sin(heading), 0}, {0, 0, 0}}));
    f.run(1);
    const Eigen::Vector3d line(std::cos(heading), std::sin(heading), 0), end = f.position("box");
    EXPECT_NEAR(end.dot(line), 4 / (2 * 0.5 * 9.8), 0.01) << "heading " << heading;
    EXPECT_NEAR(end.cross(line).z(), 0, 0.01) << "heading " << heading;
  }
}

TEST(Physics, a_spinning_top_slides_on_a_straight_line) {
  // Its edge rubs in all directions; together they only brake.
  ModelDef disk = body("disk", CylinderShape{0.3, 0.05}, at(0, 0, 0.025));
  Fixture f(world_of({ground(), disk}));
  f.run(0.1);
  ASSERT_TRUE(f.physics.set_model_twist(1, {{1, 0, 0}, {0, 0, 20}}));
  f.run(2);
  EXPECT_NEAR(f.position("disk").y(), 0, 0.03);
  EXPECT_GT(f.position("disk").x(), 0.06) << "further than without spin, v^2 / (2 mu g) = 0.05 m";
}

TEST(Physics, a_fluid_carries_what_is_lighter_and_lets_sink_what_is_heavier) {
  WorldDef world = world_of({body("even", SphereShape{0.5}, at(0, 0, -5), 1000 * 4.0 / 3 * std::numbers::pi / 8),
                             body("light", CylinderShape{0.5, 1}, at(3, 0, -5), 500 * std::numbers::pi / 4),
                             body("heavy", BoxShape{{1, 1, 1}}, at(6, 0, -5), 2000), body("raft", BoxShape{{2, 2, 1}}, at(9, 0, 0.2), 1000),
                             body("other", BoxShape{{1, 1, 1}}, at(12, 0, -5), 500)});
  world.physics.fluid = FluidDef{1000, {{0, 0}}, {"even", "light", "heavy", "raft"}};
  Fixture f(world);
  f.run(0.5);
  const double second = 0.5 * 0.5 * 0.5;  // t^2 / 2
  EXPECT_NEAR(f.position("even").z(), -5, 1e-6);
  EXPECT_NEAR(f.position("light").z(), -5 + 9.8 * second, 0.01) << "twice its weight lifts it";
  EXPECT_NEAR(f.position("heavy").z(), -5 - 4.9 * second, 0.01);
  EXPECT_NEAR(f.position("other").z(), -5 - 9.8 * second, 0.01) << "is not among the models that it carries";
  // A raft of a quarter of the density bobs about the depth at which it floats.
  double low = 9, high = -9;
  for (int i = 0; i < 5000; ++i) {
    f.physics.step();
    low = std::min(low, f.position("raft").z()), high = std::max(high, f.position("raft").z());
  }
  EXPECT_NEAR(low, 0.2, 0.005);
  EXPECT_NEAR(high, 0.3, 0.005);
}

TEST(Physics, a_cone_stands_on_its_base_and_not_on_its_tip) {
  Fixture f(world_of(
      {ground(), body("standing", ConeShape{0.3, 0.6}, at(0, 0, 0.31)), body("tipped", ConeShape{0.3, 0.6}, tilted(3, 0, 0.32, 3.1, 0))}));
  EXPECT_TRUE(f.notes.empty()) << f.notes.front();
  f.run(5);
  EXPECT_NEAR(f.position("standing").z(), 0.3, 0.01);
  EXPECT_GT(f.physics.model_pose(f.id("standing")).linear()(2, 2), 0.999);
  EXPECT_GT(f.physics.model_pose(f.id("tipped")).linear()(2, 2), -0.7) << "lies on its side";
}

// Against points on the surfaces of the shapes.
TEST(Physics, the_box_of_a_model_is_around_its_shapes_in_its_own_frame) {
  constexpr double turn = 2 * std::numbers::pi;
  const Eigen::Isometry3d link = tilted(0.3, -0.2, 0.5, 0.4, -0.7, 1.1);
  const auto boxed = [&](const GeometryDef& shape, const std::vector<Eigen::Vector3d>& surface, double precision = 1e-4) {
    ModelDef model = body("m", shape, tilted(5, 6, 7, 1, 0.5, -2));
    model.links[0].pose = link;
    Fixture f(world_of({model}));
    Eigen::AlignedBox3d wanted;
    for (const auto& point : surface) wanted.extend(link * point);
    const Eigen::AlignedBox3d box = f.physics.shape_box(0);
    EXPECT_LT((box.min() - wanted.min()).norm() + (box.max() - wanted.max()).norm(), precision)
        << kind_of(shape) << ": " << box.min().transpose() << " to " << box.max().transpose() << ", expected " << wanted.min().transpose()
        << " to " << wanted.max().transpose();
  };
  std::vector<Eigen::Vector3d> ball, rims, pill;
  for (int i = 0; i < 1000; ++i) {
    const double a = turn * i / 1000;
    for (const double z : {-0.6, 0.6}) rims.emplace_back(0.2 * std::cos(a), 0.2 * std::sin(a), z);
    for (int k = 0; k <= 500; ++k) {
      const double b = turn / 2 * k / 500;
      ball.emplace_back(0.2 * std::sin(b) * std::cos(a), 0.2 * std::sin(b) * std::sin(a), 0.2 * std::cos(b));
    }
  }
  for (const auto& point : ball) pill.push_back(point + Eigen::Vector3d(0, 0, point.z() < 0 ? -0.6 : 0.6));
  boxed(SphereShape{0.2}, ball);
  boxed(CylinderShape{0.2, 1.2}, rims);
  boxed(CapsuleShape{0.2, 1.2}, pill);
  std::vector<Eigen::Vector3d> corners;
  for (const double x : {-0.1, 0.1})
    for (const double y : {-0.2, 0.2})
      for (const double z : {-0.3, 0.3}) corners.emplace_back(x, y, z);
  boxed(BoxShape{{0.2, 0.4, 0.6}}, corners, 1e-9);
  boxed(EllipsoidShape{{0.1, 0.2, 0.3}}, ellipsoid_triangles({0.1, 0.2, 0.3}).vertices, 1e-9);
}

TEST(Physics, the_box_of_a_model_follows_its_parts_and_has_no_end_along_a_plane) {
  ModelDef thing = body("thing", SphereShape{0.5}, at(3, 4, 5));
  thing.links.push_back(link("falls", SphereShape{0.1}, 1, at(0, 0, 0.3)));
  ModelDef bare = body("bare", SphereShape{1}, at(0, 0, 9));
  bare.links[0].collisions.clear();
  ModelDef ramp = fixed("ramp", PlaneShape{Eigen::Vector3d(0.6, 0, 0.8)}, at(0, 0, -90));
  Fixture f(world_of({thing, bare, ground(), ramp}));
  EXPECT_EQ(f.physics.shape_box(0).max().z(), 0.5);
  f.physics.set_gravity(0, false);
  ASSERT_TRUE(f.physics.add_wrench({0, 1}, {0, 0, 1000}, {0, 0, 0}));
  f.run(1);
  EXPECT_NEAR(f.physics.shape_box(0).max().z(), 1.4, 0.01) << "1 m/s for a second";
  EXPECT_NEAR(f.physics.shape_box(0).min().x(), -0.5, 1e-9);
  EXPECT_TRUE(f.physics.shape_box(1).isEmpty());
  EXPECT_EQ(f.physics.shape_box(2).max(), Eigen::Vector3d(infinite, infinite, 0));
  EXPECT_EQ(f.physics.shape_box(2).min(), Eigen::Vector3d::Constant(-infinite));
  EXPECT_EQ(f.physics.shape_box(3).max(), Eigen::Vector3d::Constant(infinite));
}

TEST(Physics, shapes_of_every_kind_rest_on_each_other) {
  PolylineShape prism{{{{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {0, 0.2}, {-0.5, 0.5}}}, 0.5};
  Fixture f(world_of({ground(), fixed("prism", prism, at(0, 0, 0)), body("ball", SphereShape{0.2}, at(0.3, -0.2, 0.8)),
                      body("egg", EllipsoidShape{{0.3, 0.2, 0.2}}, at(3, 0, 0.4)), body("can", CylinderShape{0.2, 0.4}, at(5, 0, 0.4)),
                      body("pill", CapsuleShape{0.2, 0.4}, tilted(7, 0, 0.4, 1.57, 0))}));
  EXPECT_TRUE(f.notes.empty()) << f.notes.front();
  f.run(3);
  EXPECT_NEAR(f.position("ball").z(), 0.7, 0.01);
  EXPECT_NEAR(f.position("egg").z(), 0.2, 0.02);
  EXPECT_NEAR(f.position("can").z(), 0.2, 0.01);
  EXPECT_NEAR(f.position("pill").z(), 0.2, 0.01);
}

}  // namespace
}  // namespace sim

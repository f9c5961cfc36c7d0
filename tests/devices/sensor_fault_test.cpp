// Sensors and drives that are out of order on purpose: what each fault does, when it begins and ends, and that it does the same each time.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "shm/requests.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using shm::FaultKind;
using shm::IfaceType;
using namespace std::chrono_literals;

constexpr const char* laser_name = "robot::laser";
constexpr const char* drive_name = "robot::position2d";

// A robot that looks at a wall.
WorldDef before_a_wall() {
  WorldDef world;
  world.physics.step = 0.001;
  world.models = {ground(), pioneer("robot", at(0, 0, 0)), fixed("wall", BoxShape{{0.2, 20, 2}}, at(3, 0, 1))};
  return world;
}

struct FaultyRun : SimulationFixture {
  explicit FaultyRun(std::uint64_t seed = 1) : SimulationFixture(before_a_wall(), seed) {}

  shm::Iface laser = open(IfaceType::laser, laser_name);

  void put(FaultKind kind, double amount = 0, std::chrono::nanoseconds duration = {}, const std::string& iface = laser_name) {
    const auto now = simulation->time();
    const auto until = duration.count() > 0 ? now + duration : std::chrono::nanoseconds::max();
    const auto added = simulation->add_fault({iface, kind, amount, now, until});
    ASSERT_TRUE(added) << added.error().message;
  }
  // Of the next samples, ten a second.
  std::vector<float> ahead(int samples) {
    std::vector<float> ranges;
    for (int i = 0; i < samples; ++i) {
      run(0.1);
      ranges.push_back(scan()[90]);
    }
    return ranges;
  }
  std::vector<float> scan() {
    EXPECT_TRUE(laser.read());
    const auto ranges = laser.laser_scan().ranges;
    return {ranges.begin(), ranges.end()};
  }
  void move_wall(double x) { ASSERT_TRUE(simulation->set_pose(*simulation->physics().find("wall"), at(x, 0, 1))); }
};

TEST(SensorFaults, a_bias_is_added_while_it_lasts) {
  FaultyRun f;
  const float before = f.ahead(1)[0];
  f.put(FaultKind::bias, 0.5, 300ms);
  const auto ranges = f.ahead(5);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(ranges[i], before + (i < 2 ? 0.5 : 0), 1e-3) << i;  // the third is due at its end
}

TEST(SensorFaults, noise_spreads_as_it_is_told) {
  FaultyRun f;
  const float before = f.ahead(1)[0];
  f.put(FaultKind::noise, 0.2);
  double sum = 0, squares = 0;
  const auto ranges = f.ahead(400);
  for (const float range : ranges) sum += range - before, squares += (range - before) * (range - before);
  EXPECT_NEAR(sum / 400, 0, 0.04);
  EXPECT_NEAR(std::sqrt(squares / 400), 0.2, 0.03);
}

TEST(SensorFaults, one_that_is_off_says_nothing_until_the_fault_has_ended) {
  FaultyRun f;
  f.run(0.5);
  const auto sequence = f.laser.sequence();
  f.put(FaultKind::off);
  f.run(1);
  EXPECT_EQ(f.laser.sequence(), sequence);
  EXPECT_EQ(f.simulation->end_faults(laser_name, FaultKind::off), 1U);
  f.run(1);
  EXPECT_NEAR(static_cast<double>(f.laser.sequence() - sequence), 10, 1);
}

TEST(SensorFaults, one_that_is_stuck_sees_nothing_new) {
  FaultyRun f;
  f.put(FaultKind::stuck, 0, 1s);
  const float before = f.ahead(1)[0];
  f.move_wall(4);
  for (const float range : f.ahead(8)) EXPECT_EQ(range, before);
  EXPECT_NEAR(f.ahead(2)[1], before + 1, 1e-3);
}

TEST(SensorFaults, a_late_one_shows_what_was) {
  FaultyRun f;
  f.put(FaultKind::latency, 3);
  const float before = f.ahead(5)[4];
  f.move_wall(4);
  const auto ranges = f.ahead(4);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(ranges[i], before + (i < 3 ? 0 : 1), 1e-3) << i;
}

TEST(SensorFaults, the_same_beams_are_missing_each_time) {
  FaultyRun f;
  f.put(FaultKind::missing, 0.25);
  const auto missing = [&] {
    f.run(0.1);
    std::vector<std::size_t> beams;
    const auto ranges = f.scan();
    for (std::size_t i = 45; i < 136; ++i) {  // those that meet the wall
      if (std::isinf(ranges[i])) beams.push_back(i);
    }
    return beams;
  };
  const auto first = missing();
  EXPECT_NEAR(static_cast<double>(first.size()), 91 * 0.25, 12);
  EXPECT_EQ(missing(), first);
}

TEST(SensorFaults, samples_drop_out_in_the_same_way_for_a_seed_and_in_another_for_another) {
  const auto samples = [](std::uint64_t seed) {
    FaultyRun f(seed);
    f.put(FaultKind::dropout, 0.5);
    std::vector<std::uint64_t> sequence;
    for (int i = 0; i < 100; ++i) {
      f.run(0.1);
      sequence.push_back(f.laser.sequence());
    }
    return sequence;
  };
  const auto first = samples(1);
  EXPECT_EQ(samples(1), first);
  EXPECT_NE(samples(2), first);
  EXPECT_NEAR(static_cast<double>(first.back()), 50, 20);
}

TEST(SensorFaults, a_command_does_what_an_option_does) {
  const auto ranges = [](bool by_option) {
    auto server = shm::Server::start({.server_id = own_server_id(), .access = {}});
    std::vector<std::string> notes, dropped;
    const FaultOrder order{laser_name, FaultKind::noise, 0.2, 0ns, 2s};
    SimulationOptions options;
    if (by_option) options.faults = {order};
    auto made = Simulation::create(std::make_shared<const WorldDef>(before_a_wall()), **server, options, notes, dropped);
    auto& simulation = **made;
    EXPECT_TRUE(by_option || simulation.add_fault(order).ok());
    auto laser = shm::Iface::open(own_server_id(), IfaceType::laser, laser_name);
    EXPECT_TRUE(laser->subscribe());
    PartTimes times;
    std::vector<float> seen;
    simulation.sense(times);
    while (simulation.time() < 3s) {
      simulation.step(times);
      simulation.sense(times);
      if (laser->read()) seen.push_back(laser->laser_scan().ranges[90]);
    }
    return seen;
  };
  EXPECT_EQ(ranges(true), ranges(false));
}

TEST(SensorFaults, one_of_the_same_kind_takes_the_place_of_the_other) {
  FaultyRun f;
  const float before = f.ahead(1)[0];
  f.put(FaultKind::bias, 0.5);
  f.put(FaultKind::bias, 0.2);
  f.put(FaultKind::missing, 0);
  EXPECT_NEAR(f.ahead(1)[0], before + 0.2, 1e-3);
  ASSERT_EQ(f.simulation->faults().size(), 2U);
  EXPECT_EQ(f.simulation->faults()[0].amount, 0.2);
  EXPECT_EQ(f.simulation->end_faults("", std::nullopt), 2U);
  EXPECT_NEAR(f.ahead(1)[0], before, 1e-3);
}

TEST(SensorFaults, a_reset_world_has_those_of_its_options_alone) {
  std::vector<std::vector<float>> ranges;
  std::vector<std::uint64_t> hashes;
  for (const bool is_reset : {false, true}) {
    FaultyRun f;
    if (is_reset) {
      f.put(FaultKind::bias, 0.5);
      f.put(FaultKind::halted, 0, {}, drive_name);
      f.run(0.5);
      EXPECT_TRUE(f.simulation->reset(f.notes));
      EXPECT_TRUE(f.simulation->faults().empty());
    }
    ranges.push_back(f.ahead(3));
    hashes.push_back(f.simulation->hash());
  }
  EXPECT_EQ(ranges[0], ranges[1]);
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(SensorFaults, what_somebody_looks_at_while_time_stands_still_has_the_fault_and_changes_nothing) {
  std::vector<std::vector<float>> runs;
  for (const bool is_looked_at : {false, true}) {
    FaultyRun f;
    f.put(FaultKind::noise, 0.2);
    f.run(0.55);
    if (is_looked_at) {
      auto other = f.open(IfaceType::laser, laser_name);
      f.simulation->answer_new_subscribers();
      ASSERT_TRUE(other.read());
      EXPECT_GT(std::abs(other.laser_scan().ranges[90] - 2.8F), 1e-3F);
    }
    runs.push_back(f.ahead(5));
  }
  EXPECT_EQ(runs[0], runs[1]);
}

// As of a position2d: places, angles and velocities; the truth beside them stays.
TEST(DriveFaults, a_bias_reaches_the_odometry_of_what_moves_in_space) {
  WorldDef world;
  world.physics.step = 0.001;
  world.models = {body("drone", SphereShape{0.1}, at(1, 2, 3))};
  PluginDef plugin;
  plugin.name = "gz::sim::systems::VelocityControl", plugin.filename = "gz-sim-velocity-control-system";
  world.models[0].plugins.push_back(plugin);
  SimulationFixture f(std::move(world));
  auto drone = f.open(IfaceType::position3d, "drone::position3d");
  ASSERT_TRUE(drone.command(shm::CommandKind::velocity, std::array<double, 6>{}));
  f.run(0.1);
  ASSERT_TRUE(f.simulation->add_fault({"drone::position3d", FaultKind::bias, 0.25, f.simulation->time()}));
  f.run(0.1);
  ASSERT_TRUE(drone.read());
  const auto seen = drone.sample<shm::Position3dSample>();
  for (const auto& [number, place] : {std::pair(seen.odometry.x, 0.0), {seen.odometry.y, 0.0}, {seen.odometry.z, 0.0}})
    EXPECT_NEAR(number, place + 0.25, 1e-3);
  const Eigen::Isometry3d pose = from_pose(seen.odometry);
  EXPECT_NEAR(yaw_of(pose), 0.25, 1e-3);
  EXPECT_NEAR(std::asin(-pose.linear()(2, 0)), 0.25, 1e-3);
  EXPECT_NEAR(seen.velocity[0], 0.25, 1e-6);
  EXPECT_NEAR(seen.true_pose.x, 1, 1e-3);
  EXPECT_NEAR(seen.true_velocity[0], 0, 1e-6);
}

TEST(DriveFaults, a_weak_one_reaches_a_part_of_what_is_asked_for_and_a_halted_one_goes_on) {
  FaultyRun f;
  auto drive = f.open(IfaceType::position2d, drive_name);
  const auto speed_of = [&](double wanted) {
    EXPECT_TRUE(drive.command_velocity(wanted, 0, 0));
    f.run(1);
    EXPECT_TRUE(drive.read());
    return drive.sample<shm::Position2dSample>().true_velocity[0];
  };
  f.put(FaultKind::weak, 0.5, {}, drive_name);
  EXPECT_NEAR(speed_of(0.4), 0.2, 0.02);
  EXPECT_EQ(f.simulation->end_faults(drive_name, std::nullopt), 1U);
  EXPECT_NEAR(speed_of(0.4), 0.4, 0.02);
  f.put(FaultKind::halted, 0, {}, drive_name);
  EXPECT_NEAR(speed_of(0), 0.4, 0.02);
  EXPECT_EQ(f.simulation->end_faults("", FaultKind::halted), 1U);
  EXPECT_NEAR(speed_of(0), 0, 0.02);
}

TEST(Faults, that_an_iface_cannot_have_are_refused_and_change_nothing) {
  FaultyRun f;
  const auto refused = [&](const std::string& iface, FaultKind kind) {
    const auto added = f.simulation->add_fault({iface, kind, 0.5, 0ns});
    return added ? "accepted" : added.error().message;
  };
  EXPECT_EQ(refused("robot::nose", FaultKind::off), "fault off: the world has no iface robot::nose");
  EXPECT_EQ(refused(drive_name, FaultKind::missing), "fault missing of robot::position2d: only lasers and sonars have beams");
  EXPECT_EQ(refused(laser_name, FaultKind::weak), "fault weak of robot::laser: it is no position2d or position3d and has no joints");
  EXPECT_TRUE(f.simulation->faults().empty());
  EXPECT_NEAR(f.ahead(1)[0], 2.8, 0.05);
}

}  // namespace
}  // namespace sim

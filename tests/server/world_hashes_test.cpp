// The world's part of a hash log, in worlds whose models come and go.
#include "server/world_hashes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "support/naming_service.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using namespace std::chrono_literals;

class HashesOfTheWorld : public ::testing::Test {
 protected:
  // The names of the leaves of each tick that was recorded.
  std::vector<std::set<std::string>> leaves() {
    EXPECT_TRUE(hashes.finish());
    auto reader = base::HashLogReader::open(path);
    if (!reader) throw std::runtime_error(reader.error().message);
    std::vector<std::set<std::string>> all;
    base::HashTick tick;
    while (true) {
      const auto next = reader->next(tick);
      if (!next) throw std::runtime_error(next.error().message);
      if (!*next) return all;
      all.emplace_back();
      for (const auto& entry : tick.entries) all.back().insert(reader->keys().at(entry.key).text());
    }
  }
  void record() { hashes.record(*f.simulation, std::nullopt); }
  void step() {
    f.simulation->step(f.times);
    f.simulation->sense(f.times);
  }
  static WorldDef world() {
    WorldDef world;
    world.models = {ground(), pioneer("first", at(0, 0, 0)), pioneer("second", at(3, 0, 0))};
    return world;
  }
  static std::set<std::string> robot(const std::string& name) {
    return {"model " + name, "device laser " + name + "::laser", "device position2d " + name + "::position2d", "device truth " + name};
  }
  static std::set<std::string> with_ground(std::set<std::string> leaves) {
    leaves.insert("model ground");
    return leaves;
  }
  static std::set<std::string> robots(const std::string& a, const std::string& b) {
    auto both = robot(a);
    both.merge(robot(b));
    return both;
  }

  SimulationFixture f{world()};
  support::TemporaryFolder folder;
  const std::string path = (folder.path() / "world.hashlog").string();
  WorldHashes hashes = WorldHashes::open(path, 1ns).value();
};

TEST_F(HashesOfTheWorld, have_the_devices_of_a_robot_under_its_name_when_one_before_it_is_gone) {
  record();
  f.simulation->remove(1);
  step();
  record();
  const auto all = leaves();
  ASSERT_EQ(all.size(), 2U);
  EXPECT_EQ(all[0], with_ground(robots("first", "second")));
  for (const auto& leaf : all[1]) EXPECT_EQ(robot("second").count(leaf), 1U) << leaf;
  EXPECT_EQ(all[1].count("model second"), 1U);
}

TEST_F(HashesOfTheWorld, have_a_model_under_its_name_in_the_place_of_one_of_the_run_before) {
  std::vector<std::string> notes;
  ASSERT_TRUE(f.simulation->spawn(pioneer("early", at(6, 0, 0)), notes));
  record();
  ASSERT_TRUE(f.simulation->reset(notes));
  hashes.restart();
  ASSERT_TRUE(f.simulation->spawn(pioneer("late", at(6, 0, 0)), notes));
  record();
  const auto all = leaves();
  ASSERT_EQ(all.size(), 2U);
  auto before = with_ground(robots("first", "second"));
  before.merge(robot("early"));
  EXPECT_EQ(all[0], before);
  EXPECT_EQ(all[1].count("model late"), 1U);
  EXPECT_EQ(all[1].count("model early"), 0U);
}

TEST_F(HashesOfTheWorld, have_a_model_that_cannot_move_again_when_it_was_put_elsewhere) {
  record();
  step();
  record();
  ASSERT_TRUE(f.simulation->physics().set_model_pose(0, at(0, 0, -1)));
  step();
  record();
  const auto all = leaves();
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[1].count("model ground"), 0U);
  EXPECT_EQ(all[2].count("model ground"), 1U);
}

// Its laser draws at random for each beam.
WorldDef noisy_world() {
  WorldDef world;
  world.models = {ground(), pioneer("robot", at(0, 0, 0))};
  auto& ray = std::get<RayDef>(world.models[1].links[0].sensors[0].data);
  ray.noise.kind = NoiseDef::Kind::gaussian;
  ray.noise.stddev = 0.01;
  return world;
}

TEST(HashesOfASensor, are_the_same_whether_or_not_somebody_subscribes) {
  // Of each tick: the leaves and their hashes.
  using Ticks = std::vector<std::map<std::string, std::uint64_t>>;
  const auto logged = [](bool is_heard) {
    SimulationFixture f{noisy_world()};
    std::optional<shm::Iface> laser;
    if (is_heard) laser = f.open(shm::IfaceType::laser, "robot::laser");
    support::TemporaryFolder folder;
    const std::string path = (folder.path() / "world.hashlog").string();
    auto hashes = WorldHashes::open(path, 1ns).value();
    for (int i = 0; i < 250; ++i) {
      if (i > 0) f.simulation->step(f.times);
      f.simulation->sense(f.times);
      hashes.record(*f.simulation, std::nullopt);
    }
    EXPECT_TRUE(!laser || laser->sequence() > 0);
    EXPECT_TRUE(hashes.finish());
    auto reader = base::HashLogReader::open(path).value();
    Ticks ticks;
    base::HashTick tick;
    while (reader.next(tick).value()) {
      ticks.emplace_back();
      for (const auto& entry : tick.entries) ticks.back()[reader.keys().at(entry.key).text()] = entry.hash;
    }
    return ticks;
  };
  const Ticks heard = logged(true);
  ASSERT_GT(heard.size(), 1U);
  EXPECT_EQ(heard.front().count("device laser robot::laser"), 1U);
  EXPECT_EQ(heard, logged(false));
}

// What each record would be given: nothing when nobody takes part.
std::vector<int> recorded_steps(std::optional<std::chrono::nanoseconds> period, const std::function<std::optional<bool>(int)>& has_turn) {
  SimulationFixture f{noisy_world()};
  support::TemporaryFolder folder;
  const std::string path = (folder.path() / "world.hashlog").string();
  auto hashes = WorldHashes::open(path, period).value();
  std::map<std::chrono::nanoseconds, int> steps;
  for (int i = 0; i <= 300; ++i) {
    steps[f.simulation->time()] = i;
    hashes.record(*f.simulation, has_turn(i));
    EXPECT_TRUE(f.simulation->physics().set_model_pose(1, at(0.001 * i, 0, 0)));  // something has changed
    f.simulation->step(f.times);
  }
  EXPECT_TRUE(hashes.finish());
  auto reader = base::HashLogReader::open(path);
  std::vector<int> at_steps;
  base::HashTick tick;
  while (reader->next(tick).value()) at_steps.push_back(steps.at(tick.time));
  return at_steps;
}

TEST(MomentsOfWorldHashes, are_when_participants_are_called_and_not_much_rarer_or_more_often) {
  const auto every = [](int n) { return [n](int i) { return std::optional(i % n == 0); }; };
  EXPECT_EQ(recorded_steps(std::nullopt, every(50)), (std::vector{0, 50, 100, 150, 200, 250, 300}));
  EXPECT_EQ(recorded_steps(std::nullopt, every(250)), (std::vector{0, 100, 200, 250, 300}));
  EXPECT_EQ(recorded_steps(std::nullopt, every(1)).size(), 31U);
  EXPECT_EQ(recorded_steps(std::nullopt, [](int) { return std::nullopt; }).size(), 31U);
  EXPECT_EQ(recorded_steps(20ms, every(50)).size(), 16U);
}

}  // namespace
}  // namespace sim

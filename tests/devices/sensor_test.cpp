// What all devices owe to whoever looks at them, tried on a world that has one of every kind.
#include <gtest/gtest.h>

#include <map>

#include "support/paths.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;

WorldDef every_device() {
  auto loaded = load_world(std::string(paths::source_dir) + "/tests/worlds/every_device.sdf", ModelPath{});
  if (!loaded) throw std::runtime_error(loaded.error().message);
  return std::move(loaded->world);
}

struct Name {
  shm::IfaceType type;
  std::string iface;
  std::string text() const { return std::string(to_text(type)) + " " + iface; }
};

std::vector<Name> names_of(const Simulation& simulation) {
  std::vector<Name> names;
  for (const auto& device : simulation.devices()) names.push_back({device->iface().type(), device->iface().name()});
  return names;
}

// Without the stamp, which holds wall time.
std::vector<std::byte> values_of(shm::Iface& iface) {
  if (shm::has_frames(iface.type())) {
    const auto frame = iface.hold();
    if (!frame) return {};
    return {frame->data().begin(), frame->data().end()};
  }
  if (!iface.read()) return {};
  const auto bytes = iface.sample_data().subspan(sizeof(shm::Stamp));
  return {bytes.begin(), bytes.end()};
}

struct Outcome {
  std::uint64_t hash = 0;
  std::map<std::string, std::vector<std::byte>> samples;  // the last of every iface
};

// Half a second without subscribers, a look at one iface while time stands still, and fifty steps with subscribers to all.
Outcome run_with_a_look_at(const std::string& looked_at) {
  SimulationFixture f(every_device());
  f.simulation->pictures().set_synchronous(true);
  f.run(0.5);
  const auto names = names_of(*f.simulation);
  for (const auto& name : names) {
    if (name.text() != looked_at) continue;
    auto iface = f.open(name.type, name.iface);
    f.simulation->answer_new_subscribers();
    EXPECT_GT(iface.sequence(), 0U) << looked_at << " says nothing while time stands still";
  }
  f.simulation->answer_new_subscribers();
  std::vector<shm::Iface> ifaces;
  for (const auto& name : names) ifaces.push_back(f.open(name.type, name.iface));
  for (int i = 0; i < 50; ++i) {
    f.simulation->step(f.times);
    f.simulation->sense(f.times);
  }
  Outcome run{f.simulation->hash(), {}};
  for (std::size_t i = 0; i < names.size(); ++i) run.samples[names[i].text()] = values_of(ifaces[i]);
  return run;
}

TEST(Device, every_type_of_iface_has_one_in_the_world_of_this_test) {
  SimulationFixture f(every_device());
  EXPECT_EQ(f.dropped, std::vector<std::string>());
  const auto names = names_of(*f.simulation);
  for (const shm::IfaceRow& row : shm::iface_types) {
    if (row.type == shm::IfaceType::simulation) continue;
    EXPECT_TRUE(std::any_of(names.begin(), names.end(), [&](const Name& name) { return name.type == row.type; }))
        << row.name << ": tests/worlds/every_device.sdf needs one";
  }
}

TEST(Device, a_look_at_it_while_time_stands_still_changes_nothing_that_comes_later) {
  const Outcome undisturbed = run_with_a_look_at("");
  for (const auto& [name, values] : undisturbed.samples) {
    SCOPED_TRACE(name);
    EXPECT_FALSE(values.empty());
    const Outcome run = run_with_a_look_at(name);
    EXPECT_EQ(run.hash, undisturbed.hash);
    for (const auto& [other, later] : undisturbed.samples) EXPECT_EQ(run.samples.at(other), later) << other;
  }
}

TEST(Device, after_a_reset_it_says_the_same_again) {
  SimulationFixture f(every_device());
  f.simulation->pictures().set_synchronous(true);
  const auto names = names_of(*f.simulation);
  std::vector<shm::Iface> ifaces;
  for (const auto& name : names) ifaces.push_back(f.open(name.type, name.iface));
  std::vector<std::vector<std::byte>> first;
  f.run(0.2);
  const auto hash = f.simulation->hash();
  for (auto& iface : ifaces) first.push_back(values_of(iface));
  std::vector<std::string> notes;
  ASSERT_TRUE(f.simulation->reset(notes));
  f.run(0.2);
  EXPECT_EQ(f.simulation->hash(), hash);
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(values_of(ifaces[i]), first[i]) << names[i].text();
}

TEST(Device, after_a_reset_with_another_seed_it_says_what_it_says_in_a_simulator_that_started_with_that_seed) {
  const auto said = [](SimulationFixture& f) {
    f.simulation->pictures().set_synchronous(true);
    std::vector<std::vector<std::byte>> values;
    std::vector<shm::Iface> ifaces;
    for (const auto& name : names_of(*f.simulation)) ifaces.push_back(f.open(name.type, name.iface));
    f.run(0.2);
    for (auto& iface : ifaces) values.push_back(values_of(iface));
    return std::pair(values, f.simulation->hash());
  };
  auto f = std::make_unique<SimulationFixture>(every_device());
  const auto names = names_of(*f->simulation);
  const auto before = said(*f);
  std::vector<std::string> notes;
  f->simulation->set_seed(77);
  ASSERT_TRUE(f->simulation->reset(notes));
  const auto reseeded = said(*f);
  f.reset();
  f = std::make_unique<SimulationFixture>(every_device(), 77);
  const auto expected = said(*f);
  EXPECT_EQ(reseeded.second, expected.second);
  ASSERT_EQ(reseeded.first.size(), names.size());
  ASSERT_EQ(expected.first.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(reseeded.first[i], expected.first[i]) << names[i].text();
  EXPECT_NE(before.first, expected.first);
}

TEST(PartTimes, know_every_scan_of_a_laser_that_is_never_due_in_the_steps_that_stand_for_others) {
  SimulationFixture f(world_of_text(R"(<physics type="ode"><max_step_size>0.001</max_step_size></physics>
    <model name="m"><static>true</static><link name="l"><sensor name="laser" type="ray"><update_rate>10</update_rate>
      <ray><scan><horizontal><samples>500</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>
      <range><min>0.05</min><max>8</max></range></ray></sensor></link></model>)"));
  auto laser = f.open(shm::IfaceType::laser, "m::laser");
  for (int i = 0; i < 1000; ++i) {
    f.times.begin_step(f.simulation->steps());
    f.simulation->step(f.times);
    f.simulation->sense(f.times);
  }
  const auto& entries = f.times.entries();
  const auto& rays = entries[static_cast<std::size_t>(Part::rays)];
  EXPECT_EQ(rays.calls, laser.sequence());
  EXPECT_EQ(entries[static_cast<std::size_t>(Part::physics)].calls, 1000U);
  const auto& sensors = entries[static_cast<std::size_t>(Part::sensors)];
  EXPECT_LE(sensors.calls, 1000 + laser.sequence());
  EXPECT_GE(sensors.total, sensors.longest);
}

}  // namespace
}  // namespace sim

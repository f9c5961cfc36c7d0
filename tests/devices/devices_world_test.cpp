// worlds/devices.sdf has a device of each kind that the simulator knows.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "server/describe.h"
#include "support/paths.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;

TEST(DevicesWorld, has_an_iface_of_each_type) {
  const std::string worlds = std::string(paths::source_dir) + "/worlds";
  auto loaded = load_world(worlds + "/devices.sdf", ModelPath::from_environment({}, worlds));
  ASSERT_TRUE(loaded) << loaded.error().message;
  SimulationFixture f(std::move(loaded->world));
  EXPECT_EQ(f.dropped, std::vector<std::string>());
  std::set<std::string> found, known;
  // The text that simctl list --json prints.
  const auto list = nlohmann::json::parse(list_text(*f.simulation));
  for (const auto& iface : list["ifaces"]) found.insert(iface["type"].get<std::string>());
  for (const shm::IfaceRow& row : shm::iface_types) known.insert(std::string(row.name));
  known.erase("simulation");  // the world itself, which is in no list
  EXPECT_EQ(found, known);
}

TEST(DevicesWorld, has_a_scale_that_weighs_what_lies_on_it) {
  const std::string worlds = std::string(paths::source_dir) + "/worlds";
  auto loaded = load_world(worlds + "/devices.sdf", ModelPath::from_environment({}, worlds));
  ASSERT_TRUE(loaded) << loaded.error().message;
  SimulationFixture f(std::move(loaded->world));
  auto cell = f.open(shm::IfaceType::force_torque, "scale::force");
  auto plate = f.open(shm::IfaceType::bumper, "scale::touch");
  f.run(1);
  ASSERT_TRUE(cell.read() && plate.read());
  EXPECT_NEAR(cell.sample<shm::ForceTorqueSample>().force[2], -3 * 9.8, 0.2);
  EXPECT_GT(plate.bumper().contacts.size(), 0U);
}

}  // namespace
}  // namespace sim

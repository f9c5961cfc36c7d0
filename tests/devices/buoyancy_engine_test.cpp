// The bladder of an underwater vehicle, against formulas: docs/worlds.md says what it does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "support/vehicles.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

// 1 m^3 of the weight of its water, with the bladder of gz-sim's example, and drag of 200 N at 1 m/s and more of 1 m/s.
std::string diver(const std::string& volumes, const std::string& more = "") {
  return "<plugin filename='gz-sim-buoyancy-system' name='gz::sim::systems::Buoyancy'><uniform_fluid_density>1000</uniform_fluid_density>"
         "</plugin><model name='box'><pose>0 0 -20 0 0 0</pose><link name='body'><inertial><mass>1000</mass><inertia><ixx>166</ixx>"
         "<iyy>166</iyy><izz>166</izz></inertia></inertial><collision name='c'><geometry><box><size>1 1 1</size></box></geometry>"
         "</collision></link><plugin filename='gz-sim-buoyancy-engine-system' name='gz::sim::systems::BuoyancyEngine'>"
         "<link_name>body</link_name><namespace>box</namespace>" +
         volumes + "</plugin>" + more + "</model>";
}
const std::string of_example =
    "<min_volume>0</min_volume><neutral_volume>0.002</neutral_volume><default_volume>0.002</default_volume><max_volume>0.003</max_volume>"
    "<max_inflation_rate>0.0003</max_inflation_rate>";
const std::string drag =
    "<plugin filename='gz-sim-hydrodynamics-system' name='h'><link_name>body</link_name><zWabsW>-500</zWabsW></plugin>";

double depth(SimulationFixture& f) { return f.simulation->physics().model_pose(0).translation().z(); }
double rising(SimulationFixture& f) { return f.simulation->physics().link_twist({0, 0}).linear.z(); }

TEST(BuoyancyEngine, lifts_by_what_its_volume_differs_from_the_neutral_one) {
  SimulationFixture neutral(world_of_text(air + diver(of_example)));
  neutral.run(5);
  EXPECT_NEAR(depth(neutral), -20, 1e-9);
  neutral.simulation.reset(), neutral.server.reset();
  SimulationFixture full(world_of_text(
      air + diver("<neutral_volume>0.002</neutral_volume><default_volume>0.003</default_volume><max_volume>0.003</max_volume>")));
  full.run(5);
  EXPECT_NEAR(rising(full), 5 * 9.81 * 0.001, 1e-4);
}

TEST(BuoyancyEngine, pumps_no_faster_than_it_can) {
  SimulationFixture f(world_of_text(air + diver(of_example)));
  auto pilot = f.open(IfaceType::position3d, "box::buoyancy_engine");
  ASSERT_TRUE(pilot.command(shm::CommandKind::velocity, std::array<double, 6>{0, 0, 5, 0, 0, 0}));
  f.run(2);
  // The volume grows by 0.0003 t: the speed is g rho r t^2 / (2 m).
  EXPECT_NEAR(rising(f), 9.81 * 1000 * 0.0003 * 2 * 2 / 2 / 1000, 1e-4);
  f.run(18);
  EXPECT_NEAR(rising(f), 9.81 * 0.001 * (20 - 0.5 * 0.001 / 0.0003), 2e-3) << "full after 3.3 s";
}

TEST(BuoyancyEngine, follows_the_vertical_speed_and_keeps_its_depth_when_its_pilot_goes) {
  SimulationFixture f(world_of_text(air + diver(of_example, drag)));
  auto watch = f.open(IfaceType::position3d, "box::buoyancy_engine");
  {
    auto pilot = f.open(IfaceType::position3d, "box::buoyancy_engine");
    ASSERT_TRUE(pilot.command(shm::CommandKind::velocity, std::array<double, 6>{3, 0, 0.08, 0, 0, 1}));
    f.run(120);
    EXPECT_NEAR(rising(f), 0.08, 0.01);
    ASSERT_TRUE(watch.read());
    const auto seen = watch.sample<shm::Position3dSample>();
    EXPECT_NEAR(seen.command[2], 0.08, 1e-9);
    EXPECT_EQ(seen.commanded, 1U);
    EXPECT_NEAR(f.simulation->physics().link_twist({0, 0}).linear.x(), 0, 1e-9) << "it only lifts";
  }
  f.run(120);
  EXPECT_NEAR(rising(f), 0, 0.005);
}

TEST(BuoyancyEngine, comes_to_a_depth) {
  SimulationFixture f(world_of_text(air + diver(of_example, drag)));
  auto pilot = f.open(IfaceType::position3d, "box::buoyancy_engine");
  ASSERT_TRUE(pilot.command(shm::CommandKind::pose, std::array<double, 6>{0, 0, -3, 0, 0, 0}));  // 3 m below its start
  f.run(400);
  EXPECT_NEAR(depth(f), -23, 0.1);
  EXPECT_NEAR(rising(f), 0, 0.01);
}

TEST(BuoyancyEngine, above_the_surface_is_only_a_weight) {
  SimulationFixture f(world_of_text(air + diver(of_example + "<surface>-30</surface>")));
  f.run(2);
  EXPECT_NEAR(rising(f), -2 * 9.81 * 0.002, 1e-4) << "the oil of the neutral volume";
}

TEST(BuoyancyEngine, has_faults_motors_and_a_reset) {
  SimulationFixture f(world_of_text(air + diver(of_example, drag)));
  const auto at_start = f.simulation->hash();
  auto pilot = f.open(IfaceType::position3d, "box::buoyancy_engine");
  ASSERT_TRUE(f.simulation->add_fault({"box::buoyancy_engine", shm::FaultKind::weak, 0.5, f.simulation->time()}));
  ASSERT_TRUE(pilot.command(shm::CommandKind::velocity, std::array<double, 6>{0, 0, 0.1, 0, 0, 0}));
  f.run(120);
  EXPECT_NEAR(rising(f), 0.05, 0.01);
  f.simulation->device("box::buoyancy_engine")->set_motors(false);
  const double before = rising(f);
  f.run(1);
  EXPECT_NEAR(rising(f), before, 0.005) << "the bladder keeps its volume";
  std::vector<std::string> notes;
  ASSERT_TRUE(f.simulation->reset(notes));
  EXPECT_EQ(f.simulation->hash(), at_start);
}

TEST(BuoyancyEngine, that_is_wrong_is_left_out_with_one_line) {
  for (const auto& [text, expected] :
       {std::pair{diver("<min_volume>0.004</min_volume><max_volume>0.003</max_volume>"),
                  "<min_volume>, <default_volume> and <max_volume> must ascend, got 0.004, 0.004 and 0.003; the plugin is left out"},
        {diver("<min_volume>0.001</min_volume><max_volume>full</max_volume>"), "<max_volume> must be a number of 0 or more, got \"full\""},
        {diver("<max_volume>nan</max_volume>"), "<max_volume> must be a number of 0 or more, got \"nan\""},
        {diver("<default_volume>-0.5</default_volume>"), "<default_volume> must be a number of 0 or more, got \"-0.5\""},
        {diver("<default_volume>0.5</default_volume>"), "must ascend, got 3e-05, 0.5 and 0.00099; the plugin is left out"}}) {
    SimulationFixture f(world_of_text(air + text));
    ASSERT_EQ(f.dropped.size(), 1U);
    EXPECT_THAT(f.dropped[0], testing::HasSubstr(expected));
  }
  std::string text = diver("");
  text.replace(text.find("<link_name>body"), 15, "<link_name>tail");
  SimulationFixture f(world_of_text(air + text));
  ASSERT_EQ(f.dropped.size(), 1U);
  EXPECT_THAT(f.dropped[0], testing::HasSubstr("model \"box\" has no link \"tail\"; the plugin is left out"));
}

}  // namespace
}  // namespace sim

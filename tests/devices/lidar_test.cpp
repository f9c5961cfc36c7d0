// Scanners of several layers over flat ground, and scanners that turn while they move.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/paths.h"
#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"
#include "world/world_loader.h"

namespace sim {
namespace {

using namespace test;

WorldDef world_with_models(const std::string& content) {
  const std::string worlds = std::string(paths::source_dir) + "/worlds";
  auto loaded = load_world_text("<sdf version='1.9'><world name='w'>" + content + "</world></sdf>", {}, "w.sdf",
                                ModelPath::from_environment({}, worlds));
  if (!loaded) throw std::runtime_error(loaded.error().message);
  return std::move(loaded->world);
}

struct Scan {
  std::vector<float> ranges;
  std::uint32_t sweep_ns = 0;
};

Scan scan_of(SimulationFixture& f, const std::string& name, double until) {
  auto iface = f.open(shm::IfaceType::laser, name);
  f.run(until);
  if (!iface.read()) throw std::runtime_error("no scan");
  const auto scan = iface.laser_scan();
  return {{scan.ranges.begin(), scan.ranges.end()}, scan.sample->sweep_ns};
}

// The middle of the scanner is 1 m above the ground: a ring that looks down by a meets it at 1 / sin a.
TEST(Lidar, each_ring_of_a_vlp16_meets_flat_ground_where_it_looks) {
  SimulationFixture f(
      world_with_models("<include><uri>model://ground_plane</uri></include><include><uri>model://velodyne_vlp16</uri>"
                        "<name>lidar</name><static>true</static><pose>0 0 0.9623 0 0 0</pose></include>"));
  auto iface = f.open(shm::IfaceType::laser, "lidar::lidar");
  const auto& info = iface.info<shm::LaserInfo>();
  EXPECT_EQ(info.layers, 16U);
  EXPECT_EQ(info.beams, 1800U);
  EXPECT_EQ(info.rate, 10);
  const Scan scan = scan_of(f, "lidar::lidar", 0.1);
  ASSERT_EQ(scan.ranges.size(), 28800U);
  constexpr double noise = 5 * 0.008;
  for (std::size_t ring = 0; ring < 8; ++ring) {
    const double down = (15 - 2.0 * static_cast<double>(ring)) * std::numbers::pi / 180;
    for (const std::size_t beam : {std::size_t{0}, std::size_t{900}, std::size_t{1799}})
      EXPECT_NEAR(scan.ranges[ring * 1800 + beam], 1 / std::sin(down), noise + 1e-4 / std::sin(down) / std::sin(down)) << ring;
  }
  EXPECT_NEAR(scan.ranges[900], 3.864, noise);
  for (std::size_t i = 8 * 1800; i < scan.ranges.size(); ++i) ASSERT_TRUE(std::isinf(scan.ranges[i])) << i;
}

std::string falling_scanner(const std::string& rolling) {
  return "<physics type='ode'><max_step_size>0.001</max_step_size></physics><gravity>2 0 0</gravity>"
         "<model name='wall'><static>true</static><pose>5.5 0 0 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>1 9 "
         "9</size>"
         "</box></geometry></collision></link></model><model name='robot'><link name='l'><sensor name='lidar' type='gpu_lidar'>"
         "<update_rate>10</update_rate><lidar>" +
         rolling +
         "<scan><horizontal><samples>11</samples><min_angle>-0.0001</min_angle><max_angle>0.0001</max_angle></horizontal></scan>"
         "<range><min>0.1</min><max>30</max></range></lidar></sensor></link></model>";
}

// It moves by t^2 towards the wall.
TEST(Lidar, a_rolling_scan_is_seen_from_where_the_scanner_was_at_each_beam) {
  SimulationFixture f(world_of_text(falling_scanner("<rolling>true</rolling>")));
  const Scan scan = scan_of(f, "robot::lidar", 0.5);
  EXPECT_EQ(scan.sweep_ns, 100'000'000U);
  for (std::size_t i = 0; i < 11; ++i) {
    const double at = 0.4 + 0.01 * static_cast<double>(i);
    EXPECT_NEAR(scan.ranges[i], 5 - at * at, 2e-3) << i;
  }
}

TEST(Lidar, a_scan_is_seen_from_one_instant_unless_the_world_says_otherwise) {
  SimulationFixture f(world_of_text(falling_scanner("")));
  const Scan scan = scan_of(f, "robot::lidar", 0.5);
  EXPECT_EQ(scan.sweep_ns, 0U);
  for (const float range : scan.ranges) EXPECT_NEAR(range, scan.ranges[0], 1e-5);
}

TEST(Lidar, a_rolling_scan_is_the_same_after_a_reset) {
  SimulationFixture f(world_of_text(falling_scanner("<rolling>true</rolling>")));
  const Scan first = scan_of(f, "robot::lidar", 0.3);
  std::vector<std::string> notes;
  ASSERT_TRUE(f.simulation->reset(notes));
  EXPECT_EQ(scan_of(f, "robot::lidar", 0.3).ranges, first.ranges);
}

}  // namespace
}  // namespace sim

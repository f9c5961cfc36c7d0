#include "ranger_component.h"

#include <gtest/gtest.h>

#include <limits>

namespace iface {
namespace {

// 5 beams from -1 to 1.
RTC::RangerConfig ranger_config() { return {-1, 1, 0.5, 0.1, 8, 0.01, 10}; }

RTC::RangeData scan() {
  RTC::RangeData data;
  data.config = ranger_config();
  data.ranges.length(5);
  for (CORBA::ULong i = 0; i < 5; ++i) data.ranges[i] = i + 1.0;
  return data;
}

std::vector<double> ranges_of(const RTC::RangerConfig& wanted) {
  auto data = scan();
  cut(possible(ranger_config(), wanted), data);
  return {data.ranges.get_buffer(), data.ranges.get_buffer() + data.ranges.length()};
}

using Ranges = std::vector<double>;

TEST(Ranger, a_scan_is_cut_to_the_beams_inside_the_angles) {
  EXPECT_EQ(ranges_of({-0.6, 0.5, 0.5, 0, 0, 0, 0}), (Ranges{2, 3, 4}));
  EXPECT_EQ(ranges_of({-0.5, 0.49, 0, 0, 0, 0, 0}), (Ranges{2, 3}));
  const auto config = possible(ranger_config(), {-0.6, 0.5, 0.5, 0, 0, 0, 0});
  EXPECT_EQ(config.minAngle, -0.5);
  EXPECT_EQ(config.maxAngle, 0.5);
  EXPECT_EQ(config.frequency, 10);
}

TEST(Ranger, a_coarser_resolution_takes_every_nth_beam) {
  EXPECT_EQ(ranges_of({0, 0, 1, 0, 0, 0, 0}), (Ranges{1, 3, 5}));
  EXPECT_EQ(ranges_of({-1, 1, 0.8, 0, 0, 0, 0}), (Ranges{1, 3, 5}));
  EXPECT_EQ(possible(ranger_config(), {0, 0, 1.5, 0, 0, 0, 0}).maxAngle, 0.5);
  EXPECT_EQ(ranges_of({0, 0, 100, 0, 0, 0, 0}), (Ranges{1}));
}

TEST(Ranger, ranges_outside_become_the_limits) { EXPECT_EQ(ranges_of({0, 0, 0, 2, 4, 0, 0}), (Ranges{2, 2, 3, 4, 4})); }

TEST(Ranger, what_the_sensor_cannot_do_is_cut_to_what_it_can) {
  const auto config = possible(ranger_config(), {-9, 9, 0.001, 0.01, 100, 0.0001, 1000});
  EXPECT_EQ(config.minAngle, -1);
  EXPECT_EQ(config.maxAngle, 1);
  EXPECT_EQ(config.angularRes, 0.5);
  EXPECT_EQ(config.minRange, 0.1);
  EXPECT_EQ(config.maxRange, 8);
  EXPECT_EQ(config.rangeRes, 0.01);
  EXPECT_EQ(ranges_of({5, 6, 0, 0, 0, 0, 0}), (Ranges{5})) << "the beam that is nearest";
}

TEST(Ranger, a_ring_keeps_all_its_sonars) {
  RTC::RangeData data;
  data.config = {0, 0, 0.3, 0.1, 5, 0, 10};
  data.ranges.length(3);
  for (CORBA::ULong i = 0; i < 3; ++i) data.ranges[i] = 4;
  cut(possible(data.config, {-1, 1, 1, 0, 2, 0, 0}), data);
  ASSERT_EQ(data.ranges.length(), 3u);
  EXPECT_EQ(data.ranges[2], 2);
}

TEST(Ranger, bad_configurations_are_refused_with_a_line) {
  std::vector<std::string> lines;
  auto* service = new RangerService([&](bool, const std::string& line) { lines.push_back(line); });
  service->describe({}, ranger_config());
  service->SetConfig({-0.5, 0.5, 0.5, 0, 0, 0, 0});
  service->SetConfig({std::numeric_limits<double>::quiet_NaN(), 1, 0, 0, 0, 0, 0});
  service->SetConfig({1, -1, 0, 0, 0, 0, 0});
  service->SetConfig({0, 0, 0, 3, 1, 0, 0});
  EXPECT_EQ(lines.size(), 3u);
  EXPECT_EQ(service->GetConfig().maxAngle, 0.5);
  service->SetConfig({0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(service->GetConfig().maxAngle, 1);
  service->_remove_ref();
}

}  // namespace
}  // namespace iface

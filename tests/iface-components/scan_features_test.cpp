// Lines and corners of scans whose walls are known.
#include "scan_features.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace iface {
namespace {

constexpr double pi = std::numbers::pi;

// 181 beams to the front in a room whose walls are x = 3 and y = +-2.
std::vector<ScanPoint> room() {
  std::vector<ScanPoint> scan;
  for (int i = -90; i <= 90; ++i) {
    const double c = std::cos(i * pi / 180), s = std::sin(i * pi / 180);
    const double range = std::min(c > 1e-9 ? 3 / c : 1e9, std::abs(s) > 1e-9 ? 2 / std::abs(s) : 1e9);
    scan.push_back({range * c, range * s, true});
  }
  return scan;
}

TEST(ScanFeatures, of_a_room_are_its_walls_and_corners) {
  RTC::Features features;
  find_features(room(), {}, features);
  ASSERT_EQ(features.lineFeatures.length(), 3U);
  const auto& wall = features.lineFeatures[1];
  EXPECT_NEAR(wall.rho, 3, 5e-3);
  EXPECT_NEAR(wall.alpha, 0, 5e-3);
  EXPECT_TRUE(wall.startSighted && wall.endSighted) << "it ends in corners";
  EXPECT_NEAR(features.lineFeatures[0].rho, 2, 5e-3);
  EXPECT_NEAR(features.lineFeatures[0].alpha, -pi / 2, 5e-3);
  EXPECT_FALSE(features.lineFeatures[0].startSighted) << "the scan begins there";
  ASSERT_EQ(features.pointFeatures.length(), 2U);
  EXPECT_NEAR(features.pointFeatures[0].position.x, 3, 5e-3);
  EXPECT_NEAR(features.pointFeatures[0].position.y, -2, 5e-3);
  EXPECT_NEAR(features.pointFeatures[1].position.y, 2, 5e-3);
  EXPECT_EQ(features.poseFeatures.length(), 0U);
}

TEST(ScanFeatures, a_wall_that_ends_in_the_open_is_sighted_and_one_that_is_hidden_is_not) {
  auto scan = room();
  for (int i = 0; i < 60; ++i) scan[static_cast<std::size_t>(i)].is_hit = false;                    // nothing there
  for (int i = 100; i < 120; ++i) scan[static_cast<std::size_t>(i)] = {1, 0.01 * (i - 110), true};  // a post in front
  RTC::Features features;
  find_features(scan, {}, features);
  ASSERT_GE(features.lineFeatures.length(), 2U);
  const auto& wall = features.lineFeatures[0];
  EXPECT_NEAR(wall.rho, 3, 5e-3);
  EXPECT_TRUE(wall.startSighted);
  EXPECT_FALSE(wall.endSighted) << "the post hides it";
}

TEST(ScanFeatures, of_nothing_are_none) {
  RTC::Features features;
  find_features(std::vector<ScanPoint>(181), {}, features);
  EXPECT_EQ(features.lineFeatures.length() + features.pointFeatures.length(), 0U);
  find_features({}, {}, features);
  EXPECT_EQ(features.lineFeatures.length(), 0U);
}

}  // namespace
}  // namespace iface

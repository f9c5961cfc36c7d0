#include "conversions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace iface {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

shm::LaserInfo scanner() {
  shm::LaserInfo info{};
  info.beams = 3;
  info.layers = 1;
  info.min_angle = -1;
  info.max_angle = 1;
  info.angle_step = 1;
  info.min_range = 0.02;
  info.max_range = 5.6;
  info.range_step = 0.001;
  info.rate = 10;
  info.pose = {0.1, 0, 0.2, 1, 0, 0, 0};
  return info;
}

TEST(Conversions, simulated_time_keeps_its_nanoseconds) {
  const auto time = to_time(3'000'000'007);
  EXPECT_EQ(time.sec, 3u);
  EXPECT_EQ(time.nsec, 7u);
}

TEST(Conversions, ranges_on_ports_are_finite_and_never_negative) {
  EXPECT_EQ(port_range(infinity, 0.02, 5.6), 5.6);
  EXPECT_EQ(port_range(-infinity, 0.02, 5.6), 0.02);
  EXPECT_EQ(port_range(std::numeric_limits<float>::quiet_NaN(), 0.02, 5.6), 5.6);
  EXPECT_FLOAT_EQ(static_cast<float>(port_range(1.5F, 0.02, 5.6)), 1.5F);
}

TEST(Conversions, a_scan_comes_with_its_configuration_and_place) {
  shm::LaserSample sample{};
  sample.stamp.sim_time_ns = 1'500'000'000;
  const std::vector<float> ranges = {1, infinity, 2};
  RTC::RangeData data;
  to_range_data(scanner(), {&sample, ranges, {}}, 0, data);
  EXPECT_EQ(data.tm.nsec, 500'000'000u);
  ASSERT_EQ(data.ranges.length(), 3u);
  EXPECT_EQ(data.ranges[1], 5.6);
  EXPECT_EQ(data.config.minAngle, -1);
  EXPECT_EQ(data.config.angularRes, 1);
  EXPECT_EQ(data.config.frequency, 10);
  EXPECT_EQ(data.geometry.geometry.pose.position.z, 0.2);
}

TEST(Conversions, one_layer_of_a_scanner_with_many_is_taken) {
  auto info = scanner();
  info.layers = 3;
  info.min_vertical = -0.2;
  info.max_vertical = 0.2;
  EXPECT_EQ(level_layer(info), 1u);
  shm::LaserSample sample{};
  const std::vector<float> ranges = {1, 1, 1, 2, 2, 2, 3, 3, 3};
  RTC::RangeData data;
  to_range_data(info, {&sample, ranges, {}}, 2, data);
  EXPECT_EQ(data.ranges[0], 3);
  to_range_data(info, {&sample, ranges, {}}, 9, data);
  EXPECT_EQ(data.ranges.length(), 0u);
}

TEST(Conversions, points_of_all_layers_come_ring_by_ring_from_the_lowest) {
  auto info = scanner();
  info.layers = 2;
  info.min_vertical = -0.2617993878;  // 15 degrees; the ground, 1 m below, is 3.864 m away
  info.max_vertical = 0;
  shm::LaserSample sample{};
  const std::vector<float> ranges = {3.8637F, 3.8637F, infinity, 2, std::numeric_limits<float>::quiet_NaN(), -infinity};
  const std::vector<float> intensities = {0.5F, 7, 0, -1, 0, 0};
  std::vector<RayPoint> points;
  to_points(info, {&sample, ranges, intensities}, false, points);
  ASSERT_EQ(points.size(), 3u);
  EXPECT_NEAR(points[0].position[2], -1, 1e-4);
  EXPECT_NEAR(points[1].position[0], 3.7321, 1e-4);
  EXPECT_NEAR(points[0].position[1], -3.7321 * std::sin(1), 1e-4);
  EXPECT_EQ(points[0].intensity, 0.5F);
  EXPECT_EQ(points[1].intensity, 1);
  EXPECT_EQ(points[2].ring, 1u);
  EXPECT_EQ(points[2].intensity, 0);
  to_points(info, {&sample, ranges, intensities}, true, points);
  ASSERT_EQ(points.size(), 6u);
  for (const std::size_t missed : {2, 4, 5}) EXPECT_TRUE(std::isnan(points[missed].position[0])) << missed;
}

TEST(Conversions, orientations_are_roll_pitch_and_yaw) {
  const double half = 0.25;
  const auto yaw = to_orientation({0, 0, 0, std::cos(half), 0, 0, std::sin(half)});
  EXPECT_NEAR(yaw.y, 0.5, 1e-12);
  EXPECT_NEAR(yaw.r, 0, 1e-12);
  const auto pitch = to_orientation({0, 0, 0, std::cos(half), 0, std::sin(half), 0});
  EXPECT_NEAR(pitch.p, 0.5, 1e-12);
}

TEST(Conversions, courses_run_clockwise_from_north) {
  shm::GpsInfo info{};
  shm::GpsSample sample{};
  sample.stamp.valid = 1;
  sample.velocity[0] = 2;  // east
  RTC::GPSData data;
  to_gps_data(info, sample, data);
  EXPECT_NEAR(data.heading, std::acos(0.0), 1e-12);
  EXPECT_EQ(data.horizontalSpeed, 2);
  EXPECT_EQ(data.fixType, RTC::GPS_FIX_NORMAL);
}

TEST(Conversions, rays_of_pixels_go_back_through_the_lens) {
  shm::CameraInfo info{};
  info.fx = info.fy = 200;
  info.cx = 160;
  info.cy = 120;
  EXPECT_NEAR(to_ray(info, 210, 70).right, 0.25, 1e-12);
  EXPECT_NEAR(to_ray(info, 210, 70).down, -0.25, 1e-12);
  const double terms[5] = {-0.2, 0.05, 0.003, -0.002, 0.01};
  std::copy(std::begin(terms), std::end(terms), info.distortion);
  for (const double u : {0.5, 100.0, 160.0, 319.5}) {
    for (const double v : {0.5, 120.0, 239.5}) {
      const auto ray = to_ray(info, u, v);
      const double x = ray.right, y = ray.down, r2 = x * x + y * y, radial = 1 + r2 * (-0.2 + r2 * (0.05 + r2 * 0.01));
      EXPECT_NEAR(160 + 200 * (x * radial + 2 * 0.003 * x * y - 0.002 * (r2 + 2 * x * x)), u, 1e-4);
      EXPECT_NEAR(120 + 200 * (y * radial + 0.003 * (r2 + 2 * y * y) - 2 * 0.002 * x * y), v, 1e-4);
    }
  }
}

}  // namespace
}  // namespace iface

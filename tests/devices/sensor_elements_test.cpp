// What the elements of lasers and imus in SDFormat mean: layers, resolution, retro; bias, noise and frames of reference.
#include <gtest/gtest.h>

#include "support/physics_fixture.h"
#include "support/simulation_fixture.h"

namespace sim {
namespace {

using namespace test;
using shm::IfaceType;

std::string wall(double retro) {
  return "<model name='wall'><static>1</static><pose>3 0 0 0 0 0</pose><link name='l'><collision name='c'><laser_retro>" +
         std::to_string(retro) + "</laser_retro><geometry><box><size>0.2 20 8</size></box></geometry></collision></link></model>";
}

std::string eye(const std::string& scan, const std::string& more = "") {
  return "<model name='eye'><static>1</static><link name='l'><sensor name='s' type='gpu_lidar'><visualize>true</visualize><lidar><scan>" +
         scan + "</scan><range><min>0.1</min><max>20</max><resolution>0.01</resolution></range>" + more +
         "</lidar></sensor></link></model>";
}

TEST(LaserElements, layers_lie_one_above_the_other_from_the_lowest) {
  SimulationFixture f(
      world_of_text(wall(0) + eye("<horizontal><samples>5</samples><min_angle>-0.4</min_angle><max_angle>0.4</max_angle></horizontal>"
                                  "<vertical><samples>3</samples><min_angle>-0.3</min_angle><max_angle>0.1</max_angle></vertical>")));
  auto laser = f.open(IfaceType::laser, "eye::s");
  f.run(0.1);
  ASSERT_TRUE(laser.read());
  const auto scan = laser.laser_scan();
  ASSERT_EQ(scan.ranges.size(), 15U);
  for (int layer = 0; layer < 3; ++layer) {
    for (int beam = 0; beam < 5; ++beam) {
      const double up = -0.3 + 0.2 * layer, left = -0.4 + 0.2 * beam;
      const double truth = 2.9 / (std::cos(up) * std::cos(left));
      EXPECT_NEAR(scan.ranges[static_cast<std::size_t>(5 * layer + beam)], truth, 0.0051) << layer << " " << beam << ", in steps of 1 cm";
      const double steps = scan.ranges[static_cast<std::size_t>(5 * layer + beam)] / 0.01;
      EXPECT_NEAR(steps, std::round(steps), 1e-3);
    }
  }
}

TEST(LaserElements, resolution_multiplies_the_samples) {
  for (const auto& [resolution, expected] : {std::pair{"2", 20U}, std::pair{"1", 10U}, std::pair{"0.5", 5U}}) {
    SimulationFixture f(world_of_text(wall(0) + eye("<horizontal><samples>10</samples><resolution>" + std::string(resolution) +
                                                    "</resolution><min_angle>-0.4</min_angle><max_angle>0.4</max_angle></horizontal>")));
    auto laser = f.open(IfaceType::laser, "eye::s");
    EXPECT_EQ(laser.info<shm::LaserInfo>().beams, expected);
    f.run(0.1);
    ASSERT_TRUE(laser.read());
    EXPECT_NEAR(laser.laser_scan().ranges.front(), 2.9 / std::cos(0.4), 0.006);
  }
}

TEST(LaserElements, intensity_is_the_retro_of_what_is_hit) {
  SimulationFixture f(
      world_of_text(wall(1200) + eye("<horizontal><samples>2</samples><min_angle>0</min_angle><max_angle>3.1</max_angle></horizontal>")));
  auto laser = f.open(IfaceType::laser, "eye::s");
  f.run(0.1);
  ASSERT_TRUE(laser.read());
  EXPECT_EQ(laser.laser_scan().intensities[0], 1200);
  EXPECT_EQ(laser.laser_scan().intensities[1], 0) << "nothing there";
}

TEST(LaserElements, noise_has_its_mean_and_deviation_in_the_running_world) {
  SimulationFixture f(world_of_text(
      wall(0) +
      "<model name='eye'><static>1</static><link name='l'><sensor name='s' type='ray'><ray><scan><horizontal><samples>200</samples>"
      "<min_angle>0</min_angle><max_angle>1e-6</max_angle></horizontal></scan><range><min>0.1</min><max>20</max></range>"
      "<noise><type>gaussian</type><mean>0.1</mean><stddev>0.02</stddev></noise></ray></sensor></link></model>"));
  auto laser = f.open(IfaceType::laser, "eye::s");
  double sum = 0, squares = 0;
  int count = 0;
  for (int i = 0; i < 50; ++i) {
    f.run(0.001);
    ASSERT_TRUE(laser.read());
    for (const float range : laser.laser_scan().ranges) sum += range, squares += double{range} * range, ++count;
  }
  const double mean = sum / count;
  EXPECT_NEAR(mean, 3.0, 0.001);
  EXPECT_NEAR(std::sqrt(squares / count - mean * mean), 0.02, 0.001);
}

std::string body_with_imu(const std::string& imu, const std::string& pose = "0 0 0 0 0 0") {
  return "<gravity>0 0 "
         "-9.8</gravity><spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>0</latitude_deg><longitude_deg>0</"
         "longitude_deg><elevation>0</elevation>"
         "<heading_deg>30</heading_deg></spherical_coordinates><model name='m'><static>1</static><pose>" +
         pose + "</pose><link name='l'><sensor name='imu' type='imu'><imu>" + imu + "</imu></sensor></link></model>";
}

Eigen::Matrix3d orientation_of(const std::string& imu, const std::string& pose) {
  SimulationFixture f(world_of_text(body_with_imu(imu, pose)));
  auto iface = f.open(IfaceType::imu, "m::imu");
  f.run(0.01);
  EXPECT_TRUE(iface.read());
  const auto& q = iface.sample<shm::ImuSample>().orientation;
  return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
}

std::string frame(const std::string& localization) {
  return "<orientation_reference_frame><localization>" + localization + "</localization></orientation_reference_frame>";
}

TEST(ImuElements, orientation_is_told_against_the_frame_that_is_asked_for) {
  // Turned 60 degrees to the left in a world whose x axis is 30 degrees to the left of east: it looks north.
  const std::string north = "0 0 0 0 0 1.0471975511965976";
  const auto yaw = [](double angle) { return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix(); };
  EXPECT_TRUE(orientation_of("", north).isApprox(yaw(std::numbers::pi / 3), 1e-9));
  EXPECT_TRUE(orientation_of(frame("ENU"), north).isApprox(yaw(std::numbers::pi / 2), 1e-9));
  EXPECT_TRUE(orientation_of(frame("NWU"), north).isApprox(Eigen::Matrix3d::Identity(), 1e-9));
  // Forward is north; its left is west, which is minus east; its up is minus down.
  Eigen::Matrix3d ned = Eigen::Vector3d(1, -1, -1).asDiagonal();
  EXPECT_TRUE(orientation_of(frame("NED"), north).isApprox(ned, 1e-9));
  EXPECT_TRUE(orientation_of("<orientation_reference_frame><localization>CUSTOM</localization><custom_rpy>0 0 "
                             "1.0471975511965976</custom_rpy></orientation_reference_frame>",
                             north)
                  .isApprox(Eigen::Matrix3d::Identity(), 1e-9));
  EXPECT_TRUE(orientation_of("<enable_orientation>false</enable_orientation>", north).isApprox(Eigen::Matrix3d::Identity(), 1e-9));
}

TEST(ImuElements, bias_and_noise_are_those_of_the_file) {
  SimulationFixture f(world_of_text(body_with_imu(
      "<angular_velocity><x><noise "
      "type='gaussian'><mean>0</mean><stddev>0</stddev><bias_mean>0.3</bias_mean><bias_stddev>0</bias_stddev></noise></x></"
      "angular_velocity>"
      "<linear_acceleration><z><noise type='gaussian'><mean>0</mean><stddev>0.1</stddev></noise></z></linear_acceleration>")));
  auto iface = f.open(IfaceType::imu, "m::imu");
  double sum = 0, squares = 0;
  constexpr int count = 3000;
  for (int i = 0; i < count; ++i) {
    f.run(0.001);
    ASSERT_TRUE(iface.read());
    const auto& s = iface.sample<shm::ImuSample>();
    EXPECT_NEAR(std::abs(s.angular_velocity[0]), 0.3, 1e-12) << "of either sign";
    EXPECT_EQ(s.angular_velocity[1], 0);
    sum += s.acceleration[2], squares += s.acceleration[2] * s.acceleration[2];
  }
  const double mean = sum / count;
  EXPECT_NEAR(mean, 9.8, 0.01);
  EXPECT_NEAR(std::sqrt(squares / count - mean * mean), 0.1, 0.006);
}

}  // namespace
}  // namespace sim

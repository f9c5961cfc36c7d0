// Mappings of ports to messages of ROS 2, in one direction at a time: which member becomes which field.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mappings/geometry.h"
#include "mappings/mappings.h"
#include "mappings/numbers.h"
#include "mappings/sensors.h"

namespace {

using namespace ros2;
constexpr RTC::Time at{12, 345};

TEST(PortMappings, a_velocity_is_forward_left_and_about_the_vertical) {
  const auto flat = VelocityAndTwist<RTC::TimedVelocity2D>::to_ros({at, {1, 2, 3}});
  EXPECT_EQ(flat.linear.x, 1);
  EXPECT_EQ(flat.linear.y, 2);
  EXPECT_EQ(flat.angular.z, 3);
  const auto full = VelocityAndTwist<RTC::TimedVelocity3D>::to_ros({at, {1, 2, 3, 4, 5, 6}});
  EXPECT_EQ(full.linear.z, 3);
  EXPECT_EQ(full.angular.x, 4);
  EXPECT_EQ(full.angular.y, 5);
  EXPECT_EQ(full.angular.z, 6);
}

TEST(PortMappings, a_pose_has_its_heading_about_the_vertical_and_its_stamp) {
  const auto message = PoseAndPose<RTC::TimedPose2D>().to_ros({at, {{1, 2}, 0.5}});
  EXPECT_EQ(message.header.stamp.sec, 12);
  EXPECT_EQ(message.header.stamp.nanosec, 345U);
  EXPECT_EQ(message.header.frame_id, "odom");
  EXPECT_EQ(message.pose.position.x, 1);
  EXPECT_EQ(message.pose.position.y, 2);
  EXPECT_NEAR(message.pose.orientation.z, std::sin(0.25), 1e-12);
  EXPECT_NEAR(message.pose.orientation.w, std::cos(0.25), 1e-12);
  RTC::TimedPose3D pose;
  PoseAndPose<RTC::TimedPose3D>::from_ros({{{7, 8}, ""}, {{1, 2, 3}, {std::sin(0.2), 0, 0, std::cos(0.2)}}}, pose);
  EXPECT_EQ(pose.tm.sec, 7U);
  EXPECT_EQ(pose.data.position.z, 3);
  EXPECT_NEAR(pose.data.orientation.r, 0.4, 1e-12);
  EXPECT_NEAR(pose.data.orientation.p, 0, 1e-12);
  EXPECT_NEAR(pose.data.orientation.y, 0, 1e-12);
}

TEST(PortMappings, roll_pitch_and_yaw_survive_a_quaternion) {
  for (const double roll : {-2.0, 0.0, 0.7})
    for (const double pitch : {-1.2, 0.0, 1.0})
      for (const double yaw : {-3.0, 0.0, 2.0}) {
        const auto angles = ros::angles_of(ros::quaternion_of({roll, pitch, yaw}));
        EXPECT_NEAR(angles.roll, roll, 1e-9);
        EXPECT_NEAR(angles.pitch, pitch, 1e-9);
        EXPECT_NEAR(angles.yaw, yaw, 1e-9);
      }
  EXPECT_EQ(ros::angles_of({0, 0, 0, 0}).yaw, 0);
}

TEST(PortMappings, a_scan_has_infinity_for_no_echo_and_for_what_is_too_near) {
  RTC::RangeData data{};
  data.tm = at;
  data.config = {-1, 1, 0.5, 0.25, 8, 0.01, 10};
  data.ranges.length(3);
  data.ranges[0] = 8, data.ranges[1] = 0.25, data.ranges[2] = 3;
  RangesAndScan mapping;
  const auto scan = mapping.to_ros(data);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  EXPECT_EQ(std::vector<float>(scan.ranges.begin(), scan.ranges.end()), (std::vector<float>{infinity, -infinity, 3}));
  EXPECT_EQ(scan.angle_min, -1.0F);
  EXPECT_EQ(scan.angle_max, 0.0F);
  EXPECT_EQ(scan.angle_increment, 0.5F);
  EXPECT_EQ(scan.scan_time, 0.1F);
  RTC::RangeData back{};
  RangesAndScan::from_ros(scan, back);
  EXPECT_EQ(back.ranges[0], 8);
  EXPECT_EQ(back.ranges[1], 0.25);
  EXPECT_EQ(back.ranges[2], 3);
  EXPECT_EQ(back.config.minAngle, -1);
}

TEST(PortMappings, a_number_that_does_not_fit_becomes_the_nearest_one) {
  EXPECT_EQ((number_to<std::int8_t>(1000.5)), 127);
  EXPECT_EQ((number_to<std::uint8_t>(-3)), 0);
  EXPECT_EQ((number_to<std::int32_t>(-2.9)), -2);
  EXPECT_EQ((number_to<std::int64_t>(1e30)), INT64_MAX);
  EXPECT_EQ((number_to<std::int64_t>(-1e30)), INT64_MIN);
  EXPECT_EQ((number_to<std::uint64_t>(1e30F)), UINT64_MAX);
  EXPECT_EQ((number_to<std::int16_t>(std::nan(""))), 0);
  EXPECT_EQ((number_to<std::int32_t>(UINT64_MAX)), INT32_MAX);
  EXPECT_TRUE((number_to<bool>(0.5)));
}

TEST(PortMappings, the_first_mapping_of_a_type_is_its_default) {
  add_mappings();
  auto& types = MessageTypes::instance();
  const auto name = [&](const char* key) {
    MessageType* made = types.createObject(key);
    const std::string text = made == nullptr ? "" : made->name();
    if (made != nullptr) types.deleteObject(made);
    return text;
  };
  EXPECT_EQ(name("IDL:RTC/TimedVelocity2D:1.0"), "geometry_msgs/msg/Twist");
  EXPECT_EQ(name("IDL:RTC/TimedPose2D:1.0"), "nav_msgs/msg/Odometry");
  EXPECT_EQ(name("IDL:RTC/RangeData:1.0"), "sensor_msgs/msg/LaserScan");
  EXPECT_EQ(name("IDL:RTC/TimedDoubleSeq:1.0"), "std_msgs/msg/Float64MultiArray");
  EXPECT_EQ(name("sensor_msgs/JointState"), "sensor_msgs/msg/JointState");
}

}  // namespace

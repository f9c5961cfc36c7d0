// Messages of ROS 2 that command robots, and what they are made of. Units: m, rad, s. Values.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "ros/plain_messages.h"

namespace ros {

struct Accel {
  static constexpr std::string_view name = "geometry_msgs/msg/Accel";
  Vector3 linear{};
  Vector3 angular{};
  static void fields(auto& m, auto& visit) {
    visit("linear", m.linear);
    visit("angular", m.angular);
  }
};
struct JointTrajectoryPoint {
  static constexpr std::string_view name = "trajectory_msgs/msg/JointTrajectoryPoint";
  std::vector<double> positions{};
  std::vector<double> velocities{};
  std::vector<double> accelerations{};
  std::vector<double> effort{};
  Duration time_from_start{};
  static void fields(auto& m, auto& visit) {
    visit("positions", m.positions);
    visit("velocities", m.velocities);
    visit("accelerations", m.accelerations);
    visit("effort", m.effort);
    visit("time_from_start", m.time_from_start);
  }
};
struct JointTrajectory {
  static constexpr std::string_view name = "trajectory_msgs/msg/JointTrajectory";
  Header header{};
  std::vector<std::string> joint_names{};
  std::vector<JointTrajectoryPoint> points{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    visit("joint_names", m.joint_names);
    visit("points", m.points);
  }
};

}  // namespace ros

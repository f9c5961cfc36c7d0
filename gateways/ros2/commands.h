// Commands for one robot: velocities and joints, from topics to ifaces. One thread at a time.
//
// The newest command of any client and topic counts. If no further command arrives within a timeout of simulated time, the robot stops.
// Commands with NaN or infinite values are rejected and counted.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "node.h"
#include "ros/command_messages.h"
#include "shm/joint_part.h"
#include "world.h"

namespace ros2 {

struct RobotNames;

// A command that came, for those who wait for it.
struct Arrival {
  std::string topic;                              // "/leader/cmd_vel"
  std::optional<std::chrono::nanoseconds> stamp;  // of the header; nothing without one, or with stamp 0
};

class Commands {
 public:
  // False: the command does not count now.
  using OnArrival = std::function<bool(const Arrival&)>;

  Commands(Node& node, std::chrono::nanoseconds timeout, OnArrival on_arrival)
      : node_(node), timeout_(timeout), on_arrival_(std::move(on_arrival)) {}

  // Twist and TwistStamped for a drive.
  void take_drive(std::shared_ptr<Source> source, const std::string& topic);
  // JointTrajectory on `prefix`joint_trajectory, Float64MultiArray on `prefix`position_controller/commands and so on, and Float64 for each
  // joint.
  void take_joints(std::shared_ptr<Source> source, const RobotNames& names);
  // After a sample of the joints was read: trajectories go on.
  void advance();
  // Whether joints need their samples.
  bool is_moving() const { return trajectory_.has_value(); }
  const std::vector<std::string>& topics() const { return topics_; }
  std::uint64_t refused() const { return refused_; }

 private:
  struct Trajectory {
    ros::JointTrajectory message;
    std::vector<std::size_t> joints;  // of the part
    std::vector<double> from;         // positions at the start
    std::int64_t start_ns = 0;        // simulated
    bool has_started = false;
  };
  void drive(const ros::Twist& twist, const std::string& topic, std::optional<std::chrono::nanoseconds> stamp);
  void start(const ros::JointTrajectory& message, const std::string& topic);
  void set_all(std::uint32_t mode, const std::vector<double>& values, std::size_t first, const std::string& topic);
  bool is_ready();
  void refuse(const std::string& topic, const std::string& why);
  void send();

  Node& node_;
  const std::chrono::nanoseconds timeout_;
  const OnArrival on_arrival_;
  std::shared_ptr<Source> drive_, joints_;
  std::optional<shm::JointPart> part_;
  std::optional<Trajectory> trajectory_;
  std::vector<std::string> topics_;
  std::uint64_t refused_ = 0;
};

}  // namespace ros2

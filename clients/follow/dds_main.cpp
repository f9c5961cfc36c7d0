// follow-ros2: a program that speaks only DDS, and drives a robot of ros2-gateway after another one. See --help.
//
// It answers each scan with one command that carries the stamp of the scan, and uses the odometry of that time: so a run in lock step
// repeats.
#include <poll.h>
#include <signal.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "base/command_line.h"
#include "base/log.h"
#include "base/text.h"
#include "dds/participant.h"
#include "leader_tracker.h"
#include "ros/command_messages.h"
#include "ros/decode.h"
#include "steering.h"

namespace {

// sensor_msgs/msg/LaserScan with numbers of its own.
struct ReceivedScan {
  static constexpr std::string_view name = "sensor_msgs/msg/LaserScan";
  ros::Header header{};
  float angle_min = 0, angle_max = 0, angle_increment = 0, time_increment = 0, scan_time = 0, range_min = 0, range_max = 0;
  std::vector<float> ranges{}, intensities{};
  static void fields(auto& m, auto& visit) {
    visit("header", m.header);
    for (auto* one : {&m.angle_min, &m.angle_max, &m.angle_increment, &m.time_increment, &m.scan_time, &m.range_min, &m.range_max})
      visit("", *one);
    visit("ranges", m.ranges);
    visit("intensities", m.intensities);
  }
};

volatile sig_atomic_t is_ended = 0;

void report(const std::string& text) { std::cout << text << std::endl; }

double yaw_of(const ros::Quaternion& q) { return std::atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z)); }
std::int64_t nanoseconds_of(const ros::Time& time) { return std::int64_t{time.sec} * 1'000'000'000 + time.nanosec; }

class DdsFollower {
 public:
  DdsFollower(std::string robot, const follow::SteeringSettings& steering) : robot_(std::move(robot)), steering_(steering) {
    follow::TrackerSettings settings;
    settings.max_speed = steering.max_speed;
    tracker_ = follow::LeaderTracker(settings);
  }

  base::Result<void> run(const ros2::ParticipantSettings& settings) {
    auto participant = ros2::Participant::open(settings);
    if (!participant) return participant.error();
    const std::string front = "rt/" + robot_ + "/";
    ros2::EndpointSettings frames{"rt/tf_static", "tf2_msgs::msg::dds_::TFMessage_", ""};
    frames.is_transient = true;
    auto tf = (*participant)->make_reader(frames, [this](ros2::Received& received) { take_frames(received); });
    auto odom = (*participant)->make_reader({front + "odom", "nav_msgs::msg::dds_::Odometry_", ""}, [this](ros2::Received& received) {
      take_odometry(received);
    });
    auto scan = (*participant)->make_reader({front + "scan", "sensor_msgs::msg::dds_::LaserScan_", ""}, [this](ros2::Received& received) {
      take_scan(received);
    });
    auto drive = (*participant)->make_writer({front + "cmd_vel", "geometry_msgs::msg::dds_::TwistStamped_", ""});
    if (!tf || !odom || !scan || !drive) return base::Error{"cannot create the DDS endpoints"};
    drive_ = drive->get();
    while (is_ended == 0) {
      pollfd news{(*participant)->descriptor(), POLLIN, 0};
      ::poll(&news, 1, 200);
      (*participant)->deliver();
      if (!is_connected_ && mount_ && !drive_->readers().empty() && !(*scan)->writers().empty() && !(*odom)->writers().empty()) {
        is_connected_ = true;
        report("connected to " + robot_);
      }
    }
    return {};
  }

 private:
  void take_frames(const ros2::Received& received) {
    const auto message = ros::decode<ros::TFMessage>(received.bytes);
    if (!message) return;
    for (const auto& one : message->transforms) {
      if (one.child_frame_id != robot_ + "/laser") continue;
      const auto& t = one.transform;
      mount_ = {t.translation.x, t.translation.y, yaw_of(t.rotation)};
    }
  }

  void take_odometry(const ros2::Received& received) {
    const auto message = ros::decode<ros::Odometry>(received.bytes);
    if (!message) return;
    const auto& pose = message->pose.pose;
    const auto time = nanoseconds_of(message->header.stamp);
    if (time < last_odometry_) odometry_.clear();  // the world was reset
    last_odometry_ = time;
    odometry_[time] = {pose.position.x, pose.position.y, yaw_of(pose.orientation)};
    steer();
  }

  void take_scan(const ros2::Received& received) {
    scan_ = ros::decode<ReceivedScan>(received.bytes);
    steer();
  }

  // When both are there.
  void steer() {
    if (!scan_ || !mount_ || odometry_.empty()) return;
    const auto time = nanoseconds_of(scan_->header.stamp);
    if (time == 0) scan_.reset();  // a stamp of 0 is none: no tick waits for the answer
    if (!scan_ || last_odometry_ < time) return;
    const auto after = odometry_.upper_bound(time);
    if (after == odometry_.begin()) return;
    const follow::Pose place = std::prev(after)->second;
    odometry_.erase(odometry_.begin(), std::prev(after));
    const follow::Scan beams{scan_->angle_min, scan_->angle_increment, scan_->range_max, scan_->ranges};
    for (float& range : scan_->ranges) range = std::isfinite(range) ? range : range > 0 ? scan_->range_max : scan_->range_min;
    const double seconds = static_cast<double>(time) * 1e-9;
    const auto leader = tracker_.update(beams, *mount_, place, seconds);
    tell(leader);
    if (leader) {
      const auto around = follow::around(beams, *leader, steering_);
      velocity_ = around ? *around : follow::towards(*leader, steering_);
    } else if (tracker_.unseen(seconds).value_or(1) > 0.8) {
      velocity_ = {};
    }
    ros::TwistStamped command{scan_->header, {{velocity_.forward, 0, 0}, {0, 0, velocity_.turn}}};
    drive_->write(ros::encoded_size(command), [&](std::span<char> room) { ros::encode(command, room); });
    scan_.reset();
  }

  void tell(const std::optional<follow::Sighting>& leader) {
    if (leader.has_value() == is_following_) return;
    is_following_ = leader.has_value();
    report(leader ? fmt::format("leader at {:.2f} m, {:.0f} degrees", leader->distance,
                                std::round(leader->bearing * 180 / std::numbers::pi) + 0.0)
                  : "leader not seen");
  }

  const std::string robot_;
  const follow::SteeringSettings steering_;
  follow::LeaderTracker tracker_;
  ros2::Writer* drive_ = nullptr;
  std::optional<follow::Pose> mount_;
  std::map<std::int64_t, follow::Pose> odometry_;  // by time
  std::int64_t last_odometry_ = -1;
  std::optional<ReceivedScan> scan_;
  follow::Velocity velocity_;
  bool is_following_ = false, is_connected_ = false;
};

}  // namespace

int main(int argc, char** argv) {
  base::Command app{
      "follow-ros2: drive a robot of ros2-gateway after another one\nSpeaks only DDS, with topics and types of ROS 2. Answers each scan "
      "with a "
      "command that has the stamp of the scan."};
  base::add_standard_options(app, "follow-ros2", RTMSIM_VERSION);
  std::string robot = "follower", network = "host";
  ros2::ParticipantSettings settings;
  follow::SteeringSettings steering;
  app.add_option("--robot", robot, "Namespace of the robot")->capture_default_str();
  app.add_option("--domain", settings.domain, "DDS domain")
      ->check(base::integer_between(0, 232))
      ->envname("ROS_DOMAIN_ID")
      ->capture_default_str();
  app.add_option("--network", network, "Reach, as of ros2-gateway")
      ->check(base::one_of({"host", "lan", "loopback"}))
      ->capture_default_str();
  app.add_option("--distance", steering.distance, "Distance to the leader [m]")
      ->check(base::number_between(0.4, 10))
      ->capture_default_str();
  app.add_option("--max-speed", steering.max_speed, "Maximum speed [m/s]")->check(base::number_between(0, 10))->capture_default_str();
  if (const auto end = base::parse_command_line(app, "follow-ros2", argc, argv)) return *end;
  settings.network = network == "lan" ? ros2::Network::lan : network == "loopback" ? ros2::Network::loopback : ros2::Network::host;
  settings.user_data.clear();  // as a plain DDS program, which is no node of ROS
  for (const int signal : {SIGINT, SIGTERM}) ::signal(signal, [](int) { is_ended = 1; });
  if (const auto done = DdsFollower(robot, steering).run(settings); !done) {
    std::cerr << "follow-ros2: " << done.error().message << '\n';
    return 1;
  }
  return 0;
}

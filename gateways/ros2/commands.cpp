#include "commands.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/log.h"
#include "naming.h"
#include "ros/from_iface.h"

namespace ros2 {
namespace {

std::optional<std::chrono::nanoseconds> stamp_of(const ros::Header& header) {
  const auto time = std::chrono::seconds(header.stamp.sec) + std::chrono::nanoseconds(header.stamp.nanosec);
  if (time.count() == 0) return std::nullopt;
  return time;
}

std::chrono::nanoseconds duration_of(const ros::Duration& duration) {
  return std::chrono::seconds(duration.sec) + std::chrono::nanoseconds(duration.nanosec);
}

bool are_finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

// A cubic from one position and velocity to another: where it is after `at` of `whole` seconds.
struct Point {
  double position = 0, velocity = 0;
};
Point between(Point from, Point to, double at, double whole) {
  if (whole <= 0 || at >= whole) return to;
  const double u = at / whole;
  const double a = 2 * u * u * u - 3 * u * u + 1, b = u * u * u - 2 * u * u + u, c = 3 * u * u - 2 * u * u * u, d = u * u * u - u * u;
  const double va = 6 * u * u - 6 * u, vb = 3 * u * u - 4 * u + 1, vc = 6 * u - 6 * u * u, vd = 3 * u * u - 2 * u;
  return {a * from.position + b * whole * from.velocity + c * to.position + d * whole * to.velocity,
          (va * from.position + vc * to.position) / whole + vb * from.velocity + vd * to.velocity};
}

base::Result<void> set(shm::JointPart& part, std::uint32_t mode, std::size_t joint, double value) {
  if (!std::isfinite(value)) return base::Error{"has a value that is not finite"};
  if (mode == RTMSIM_JOINT_POSITION) return part.follow(joint, value, 0, 0);
  if (mode == RTMSIM_JOINT_VELOCITY) return part.turn(joint, value);
  return part.push(joint, value);
}

}  // namespace

void Commands::take_drive(std::shared_ptr<Source> source, const std::string& topic) {
  drive_ = std::move(source);
  topics_.push_back(topic);
  node_.subscribe<ros::Twist>(topic, [this, topic](const ros::Twist& twist) { drive(twist, topic, std::nullopt); });
  node_.subscribe<ros::TwistStamped>(
      topic, [this, topic](const ros::TwistStamped& message) { drive(message.twist, topic, stamp_of(message.header)); });
}

void Commands::drive(const ros::Twist& twist, const std::string& topic, std::optional<std::chrono::nanoseconds> stamp) {
  if (!on_arrival_({topic, stamp})) return;
  const bool is_3d = drive_->iface().type() == shm::IfaceType::position3d;
  const std::array<double, 6> all = {twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y, twist.angular.z};
  const std::array<double, 3> flat = {twist.linear.x, twist.linear.y, twist.angular.z};
  const auto values = is_3d ? std::span<const double>(all) : std::span<const double>(flat);
  if (auto done = drive_->iface().command(shm::CommandKind::velocity, values, timeout_); !done) refuse(topic, done.error().message);
}

void Commands::refuse(const std::string& topic, const std::string& why) {
  constexpr std::uint64_t max_lines = 10;
  if (++refused_ <= max_lines) base::log(base::Level::warn, "ros2-gateway", "{}: {}", topic, why);
}

// ---- joints ----

void Commands::take_joints(std::shared_ptr<Source> source, const RobotNames& names) {
  joints_ = std::move(source);
  const auto trajectory = names.topic("joint_trajectory");
  topics_.push_back(trajectory);
  node_.subscribe<ros::JointTrajectory>(trajectory,
                                        [this, trajectory](const ros::JointTrajectory& message) { start(message, trajectory); });
  static constexpr std::array<std::pair<const char*, std::uint32_t>, 3> groups = {
      {{"position", RTMSIM_JOINT_POSITION}, {"velocity", RTMSIM_JOINT_VELOCITY}, {"effort", RTMSIM_JOINT_EFFORT}}};
  for (const auto& [group, mode] : groups) {
    const auto topic = names.topic(std::string(group) + "_controller/commands");
    topics_.push_back(topic);
    node_.subscribe<ros::Float64MultiArray>(topic, [this, topic, mode = mode](const ros::Float64MultiArray& message) {
      const std::size_t wanted = joints_->iface().count();
      if (message.data.size() == wanted) return set_all(mode, message.data, 0, topic);
      refuse(topic, "has " + std::to_string(message.data.size()) + " values, expected " + std::to_string(wanted));
    });
  }
  const auto* joints = reinterpret_cast<const shm::Joint*>(joints_->iface().info_followers(0));
  for (std::size_t i = 0; i < joints_->iface().count(); ++i) {
    const auto topic = names.topic(token(ros::text_of(joints[i].name)) + "/position_command");
    topics_.push_back(topic);
    node_.subscribe<ros::Float64>(
        topic, [this, topic, i](const ros::Float64& message) { set_all(RTMSIM_JOINT_POSITION, {message.data}, i, topic); });
  }
}

bool Commands::is_ready() {
  if (part_) return true;
  part_.emplace();
  if (auto chosen = part_->choose(joints_->iface(), ""); !chosen) {
    refuse(node_.name().full(), chosen.error().message);
    part_.reset();
    return false;
  }
  return true;
}

void Commands::set_all(std::uint32_t mode, const std::vector<double>& values, std::size_t first, const std::string& topic) {
  if (!is_ready() || !on_arrival_({topic, std::nullopt})) return;
  shm::JointPart commanded = *part_;  // all or none
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (auto done = set(commanded, mode, first + i, values[i]); !done) return refuse(topic, done.error().message);
  }
  part_ = std::move(commanded);
  trajectory_.reset();
  send();
}

void Commands::start(const ros::JointTrajectory& message, const std::string& topic) {
  if (!is_ready() || !on_arrival_({topic, stamp_of(message.header)})) return;
  if (message.points.empty()) {
    trajectory_.reset();
    return;
  }
  Trajectory trajectory{message, {}, {}, 0, false};
  for (const auto& name : message.joint_names) {
    std::size_t i = 0;
    while (i < part_->size() && ros::text_of(part_->joint(i).name) != name) ++i;
    if (i == part_->size()) return refuse(topic, "the robot has no joint \"" + name + "\"");
    if (std::ranges::find(trajectory.joints, i) != trajectory.joints.end()) return refuse(topic, "joint_names has \"" + name + "\" twice");
    trajectory.joints.push_back(i);
  }
  if (trajectory.joints.empty()) return refuse(topic, "joint_names is empty");
  shm::JointPart checked = *part_;
  std::chrono::nanoseconds before{-1};
  for (const auto& point : message.points) {
    if (point.positions.size() != trajectory.joints.size() || !are_finite(point.positions) || !are_finite(point.velocities) ||
        (!point.velocities.empty() && point.velocities.size() != point.positions.size()))
      return refuse(topic, "each point needs as many finite positions as there are joint_names, and as many velocities or none");
    if (duration_of(point.time_from_start) <= before) return refuse(topic, "time_from_start must grow from point to point");
    before = duration_of(point.time_from_start);
    for (std::size_t i = 0; i < trajectory.joints.size(); ++i) {
      if (auto done = checked.follow(trajectory.joints[i], point.positions[i], 0, 0); !done) return refuse(topic, done.error().message);
    }
  }
  trajectory.start_ns = stamp_of(message.header).value_or(std::chrono::nanoseconds(-1)).count();
  trajectory_ = std::move(trajectory);
}

void Commands::advance() {
  if (!joints_ || !part_ || !trajectory_) return;
  part_->read(joints_->iface());
  auto& run = *trajectory_;
  const std::int64_t now = joints_->iface().sample<shm::JointsSample>().stamp.sim_time_ns;
  if (!run.has_started) {
    run.has_started = true;
    if (run.start_ns < 0) run.start_ns = now;
    for (const std::size_t joint : run.joints) run.from.push_back(part_->state(joint).position);
  }
  const double at = static_cast<double>(now - run.start_ns) * 1e-9;
  const auto seconds = [&](std::size_t i) {
    return std::chrono::duration<double>(duration_of(run.message.points[i].time_from_start)).count();
  };
  std::size_t next = 0;
  while (next + 1 < run.message.points.size() && seconds(next) < at) ++next;
  const double begin = next == 0 ? 0 : seconds(next - 1);
  for (std::size_t i = 0; i < run.joints.size(); ++i) {
    const auto point = [&](std::size_t k) {
      const auto& p = run.message.points[k];
      return Point{p.positions[i], p.velocities.empty() ? 0 : p.velocities[i]};
    };
    const Point wanted =
        between(next == 0 ? Point{run.from[i], 0} : point(next - 1), point(next), std::max(at - begin, 0.0), seconds(next) - begin);
    // A joint may begin a little beyond its stop, and a curve swing beyond one.
    const auto& joint = part_->joint(run.joints[i]);
    if (auto done = part_->follow(run.joints[i], std::clamp(wanted.position, joint.lower, joint.upper), wanted.velocity, 0); !done) {
      refuse("joint_trajectory", done.error().message);
      trajectory_.reset();
      return;
    }
  }
  send();
  if (at >= seconds(run.message.points.size() - 1)) trajectory_.reset();
}

void Commands::send() {
  if (auto done = part_->send(joints_->iface()); !done) refuse(node_.name().full(), done.error().message);
}

}  // namespace ros2

#include "devices/sensors/sensor_fault.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>

#include "base/fault_text.h"
#include "base/text.h"
#include "devices/device.h"
#include "shm/iface_types.h"

namespace sim {
namespace {

using Kind = SensorFault::Kind;

bool has_ranges(const shm::IfaceWriter& writer) { return writer.type() == shm::IfaceType::laser || writer.type() == shm::IfaceType::sonar; }

// What is measured; not what the simulator says of itself beside it.
bool is_measured(const shm::Field& field) {
  return field.kind == shm::Field::Kind::f64 && !field.name.starts_with("true") && field.name != "command" && field.name != "covariance";
}

// The odometry of what moves in space is a pose; `true_pose` is what the simulator says.
bool is_measured_pose(const shm::Field& field) { return field.kind == shm::Field::Kind::pose && field.name == "odometry"; }

// The place and the angles about x, y and z, each with its own change.
shm::Pose changed_pose(const shm::Pose& pose, const std::function<double(double)>& change) {
  const Eigen::Quaterniond q(pose.qw, pose.qx, pose.qy, pose.qz);
  const Eigen::Matrix3d m = q.normalized().toRotationMatrix();
  const double roll = change(std::atan2(m(2, 1), m(2, 2))), pitch = change(std::asin(std::clamp(-m(2, 0), -1.0, 1.0))),
               yaw = change(std::atan2(m(1, 0), m(0, 0)));
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitY()) *
                  Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitX()))
                     .toRotationMatrix();
  out.translation() = Eigen::Vector3d(change(pose.x), change(pose.y), change(pose.z));
  return to_pose(out);
}

bool has_joints(const shm::IfaceWriter& writer) { return writer.type() == shm::IfaceType::joints; }

}  // namespace

// The whole sample that waits to be published, but for its stamp; or what one joint measures: position, velocity, effort.
std::span<std::byte> SensorFault::measured(shm::IfaceWriter& writer) const {
  if (joint_)
    return std::as_writable_bytes(writer.followers<shm::JointState>(0).subspan(*joint_, 1)).first(offsetof(shm::JointState, target));
  const auto& row = shm::row_of(writer.type());
  auto* start = reinterpret_cast<std::byte*>(&writer.sample<shm::Stamp>());
  const auto size = row.sample_size + row.sample_tail.arrays * writer.count() * row.sample_tail.size;
  return {start + sizeof(shm::Stamp), size - sizeof(shm::Stamp)};
}

base::Result<FaultOrder> parse_fault_order(const std::string& text) {
  const auto parsed = base::parse_fault_text(text, "IFACE");
  if (!parsed) return parsed.error();
  const auto row = shm::check_fault(parsed->kind, parsed->amount);
  if (!row) return row.error();
  return FaultOrder{parsed->last, (*row)->kind, parsed->amount.value_or((*row)->amount.value_or(0)), parsed->from, parsed->until};
}

base::Result<SensorFault> SensorFault::make(const FaultOrder& order, const shm::IfaceWriter& writer, std::uint64_t seed,
                                            std::optional<std::size_t> joint) {
  const std::string kind(shm::row_of(order.kind).name);
  const auto fail = [&](const std::string& what) { return base::Error{"fault " + kind + " of " + order.iface + ": " + what}; };
  const auto& row = shm::row_of(writer.type());
  if (row.sample_size == 0) return fail("its frames cannot be changed");
  if (writer.type() == shm::IfaceType::boxes) return fail("its boxes come with frames, which cannot be changed");
  if (order.kind == Kind::missing && !has_ranges(writer)) return fail("only lasers and sonars have beams");
  const bool is_changed = order.kind == Kind::bias || order.kind == Kind::noise;
  if (joint && (order.kind == Kind::off || order.kind == Kind::dropout))
    return fail("joints have one sample together: name " + writer.name());
  if (is_changed && !has_ranges(writer) && !has_joints(writer) && std::ranges::none_of(row.sample, is_measured))
    return fail("it measures no numbers");
  return SensorFault(order, RandomStream(seed, "fault " + kind + " " + order.iface), joint);
}

bool SensorFault::leaves_out(std::chrono::nanoseconds time) const {
  return kind_ == Kind::off || (kind_ == Kind::dropout && random_.at(time).uniform() < amount_);
}

void SensorFault::apply(shm::IfaceWriter& writer, std::chrono::nanoseconds time) {
  switch (kind_) {
    case Kind::stuck:
    case Kind::latency:
      return exchange(writer);
    case Kind::bias:
    case Kind::noise:
      return disturb(writer, random_.at(time));
    case Kind::missing:
      return lose_beams(writer, random_);
    case Kind::off:
    case Kind::dropout:
    case Kind::weak:
    case Kind::halted:
      break;
  }
}

// Until there is one that is late enough, the first stays.
void SensorFault::exchange(shm::IfaceWriter& writer) {
  const auto now = measured(writer);
  const bool is_stuck = kind_ == Kind::stuck;
  if (!is_stuck || kept_.empty()) kept_.emplace_back(now.begin(), now.end());
  std::ranges::copy(kept_.front(), now.begin());
  if (!is_stuck && kept_.size() > static_cast<std::size_t>(amount_)) kept_.pop_front();
}

void SensorFault::disturb(shm::IfaceWriter& writer, RandomStream random) const {
  const auto change = [&](double value) { return value + (kind_ == Kind::bias ? amount_ : amount_ * random.gaussian()); };
  if (has_ranges(writer)) {
    for (float& range : writer.ranges()) {
      if (std::isfinite(range)) range = static_cast<float>(std::max(0.0, change(static_cast<double>(range))));
    }
    return;
  }
  if (has_joints(writer)) {
    const auto joints = writer.followers<shm::JointState>(0);
    for (auto& joint : joint_ ? joints.subspan(*joint_, 1) : joints) joint.position = change(joint.position);
    return;
  }
  for (const shm::Field& field : shm::row_of(writer.type()).sample) {
    if (is_measured_pose(field)) {
      auto& pose = *static_cast<shm::Pose*>(const_cast<void*>(field.in(&writer.sample<shm::Stamp>())));
      pose = changed_pose(pose, change);
    }
    if (!is_measured(field)) continue;
    // The table gives read access to whatever it is asked about; this sample is ours to write.
    auto* values = static_cast<double*>(const_cast<void*>(field.in(&writer.sample<shm::Stamp>())));
    for (std::size_t i = 0; i < field.count; ++i) values[i] = change(values[i]);
  }
}

// The same beams each time.
void SensorFault::lose_beams(shm::IfaceWriter& writer, RandomStream random) const {
  for (float& range : writer.ranges()) {
    if (random.uniform() < amount_) range = std::numeric_limits<float>::infinity();
  }
}

}  // namespace sim

#include "rtc_position3d.h"

#include <algorithm>
#include <cmath>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCPosition3d",
    .description = "Flight or free movement of a simulated robot",
    .phase = iface::command_phase,
    .device = "helicopter::position3d",
    .parameters = iface::drive_parameters(),
};

RTCPosition3d::RTCPosition3d(RTC::Manager* manager)
    : DriveComponent(manager, specification, shm::IfaceType::position3d),
      pose_in_("pose_control", wanted_pose_),
      heading_in_("heading_control", heading_),
      path_in_("path", path_),
      pose_out_("pose", pose_),
      actual_velocity_out_("actual_velocity", actual_velocity_),
      odometry_service_([this](const RTC::Pose3D& pose) {
        const auto& [at, turn] = pose;
        shm::ResetOdometryRequest request;
        request.is_3d = true;
        request.pose = shm::euler_pose(at.x, at.y, at.z, turn.r, turn.p, turn.y);
        set_odometry(std::move(request));
        was_odometry_set_.store(true, std::memory_order_release);  // pairs with go_on
      }) {}

RTC::ReturnCode_t RTCPosition3d::onInitialize() {
  addVelocityPort();
  addInPort("pose_control", pose_in_);
  addInPort("heading_control", heading_in_);
  addInPort("path", path_in_);
  addOutPort("pose", pose_out_);
  addOutPort("actual_velocity", actual_velocity_out_);
  service_port().registerProvider("odometry", "RTC::Odometry3D", odometry_service_);
  service_port().registerProvider("velocity_control", "RTC::VelocityControl3D", velocity_service_);
  service_port().registerProvider("pose_control", "RTC::PoseControl3D", pose_service_);
  service_port().registerProvider("heading_control", "RTC::HeadingControl3D", heading_service_);
  service_port().registerProvider("path_follower", "RTC::PathFollower3D", path_follower_);
  bindDrive();
  return RTC::RTC_OK;
}

void RTCPosition3d::describe(const shm::Iface& robot) {
  DriveComponent::describe(robot);
  const auto& info = robot.info<shm::Position3dInfo>();
  odometry_service_.describe(iface::to_geometry(info.pose, info.size));
  velocity_service_.describe(iface::to_geometry(info.pose, info.size));
  pose_service_.describe(iface::to_geometry(info.pose, info.size));
  heading_service_.describe(iface::to_geometry(info.pose, info.size));
}

void RTCPosition3d::detaching() {
  goal_ = {};
  DriveComponent::detaching();
}

void RTCPosition3d::command(const std::array<double, 6>& values, shm::CommandKind kind) {
  commanding_client().received(values, kind);  // in real time it drives
  if (iface::in_simulated_time()) commanding_client().drive(values, kind);
}

// Values that are no numbers are ignored with a line: the robot goes on as before.
void RTCPosition3d::read_goals() {
  const auto are_numbers = [](std::initializer_list<double> values) {
    return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
  };
  read_path();
  bool has_pose = false, has_heading = false;
  while (pose_in_.isNew()) has_pose = pose_in_.read() || has_pose;
  while (heading_in_.isNew()) has_heading = heading_in_.read() || has_heading;
  if (has_heading) {
    const auto& [speed, direction] = heading_.data;
    if (are_numbers({speed, direction.p, direction.y})) {
      goal_ = Heading{speed, direction.p, direction.y};
      resets_.reset();
      command({}, shm::CommandKind::velocity);  // command_timeout stops the robot when no more come
    } else {
      RTC_WARN(
          ("heading_control: expected finite numbers, got %g m/s, pitch %g rad and yaw %g rad; ignored", speed, direction.p, direction.y));
    }
  }
  if (has_pose) {
    const auto& [at, turn] = wanted_pose_.data;
    if (are_numbers({at.x, at.y, at.z, turn.r, turn.p, turn.y})) {
      goal_ = Goal{at.x, at.y, at.z, turn.r, turn.p, turn.y};
      resets_.reset();
    } else {
      RTC_WARN(("pose_control: expected finite numbers, got position %g, %g, %g m; ignored", at.x, at.y, at.z));
    }
  }
}

void RTCPosition3d::read_path() {
  bool has_path = false;
  while (path_in_.isNew()) has_path = path_in_.read() || has_path;
  if (has_path && !path_follower_.set(path_.waypoints)) RTC_WARN(("path: expected finite numbers and at most 10000 way points; ignored"));
  if (!path_follower_.take_news()) return;
  if (!std::holds_alternative<std::monostate>(goal_)) commanding_client().stop();
  goal_ = Following{};
  last_.reset();
  resets_.reset();
}

// The pose of the last way point stays the goal.
void RTCPosition3d::follow(const shm::Position3dSample& sample) {
  const auto [pose, is_waiting] = path_follower_.next(sample.odometry);
  if (pose) {
    last_ = *pose;
    command(*pose, shm::CommandKind::pose);
  } else if (is_waiting) {
    command({}, shm::CommandKind::velocity);
  } else if (last_) {
    goal_ = *last_;
    command(*last_, shm::CommandKind::pose);
  } else {
    goal_ = {};
    command({}, shm::CommandKind::velocity);
  }
}

void RTCPosition3d::go_on(const shm::Position3dSample& sample) {
  constexpr double fastest_turn = 1, gain = 2;                                                        // [rad/s], [1/s]
  const bool was_set = was_odometry_set_.exchange(false, std::memory_order_acquire);                  // pairs with SetOdometry
  const bool is_elsewhere = was_set || resets_.value_or(sample.stamp.resets) != sample.stamp.resets;  // what the goal was
  resets_ = sample.stamp.resets;
  if (is_elsewhere && !std::holds_alternative<std::monostate>(goal_)) {
    goal_ = {};
    commanding_client().stop();
  }
  if (std::holds_alternative<Following>(goal_)) {
    follow(sample);
    return;
  }
  path_follower_.end();
  if (const auto* pose = std::get_if<Goal>(&goal_)) {
    command(*pose, shm::CommandKind::pose);
  } else if (const auto* heading = std::get_if<Heading>(&goal_)) {
    const double error = std::remainder(heading->yaw - shm::yaw_of(sample.odometry), 2 * std::acos(-1.0));
    const double velocity[] = {heading->speed * std::cos(heading->pitch),
                               0,
                               -heading->speed * std::sin(heading->pitch),
                               0,
                               0,
                               std::clamp(gain * error, -fastest_turn, fastest_turn)};
    commanding_client().drive(velocity);
  }
}

void RTCPosition3d::publish(const shm::Iface& robot) {
  const auto& sample = robot.sample<shm::Position3dSample>();
  go_on(sample);
  pose_.tm = iface::to_time(sample.stamp.sim_time_ns);
  pose_.data = iface::to_pose(sample.odometry);
  pose_out_.write();
  const auto& v = sample.velocity;
  actual_velocity_.tm = pose_.tm;
  actual_velocity_.data = {v[0], v[1], v[2], v[3], v[4], v[5]};
  actual_velocity_out_.write();
}

extern "C" {
void RTCPosition3dInit(RTC::Manager* manager) { iface::register_type<RTCPosition3d>(manager, specification); }
}

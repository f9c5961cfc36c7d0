#include "rtc_position2d.h"

#include <cmath>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCPosition2d",
    .description = "Drive of a simulated robot",
    .phase = iface::command_phase,
    .device = "pioneer2dx::position2d",
    .parameters = iface::drive_parameters(),
};

RTCPosition2d::RTCPosition2d(RTC::Manager* manager)
    : DriveComponent(manager, specification, shm::IfaceType::position2d),
      pose_in_("pose_control", pose_),
      heading_in_("heading_control", heading_),
      car_in_("carlike_control", car_),
      path_in_("path", path_),
      odometry_out_("odometry", odometry_),
      actual_velocity_out_("actual_velocity", actual_velocity_),
      odometry_service_([this](const RTC::Pose2D& pose) {
        shm::ResetOdometryRequest request;
        request.x = pose.position.x, request.y = pose.position.y, request.a = pose.heading;
        set_odometry(std::move(request));
        was_odometry_set_.store(true, std::memory_order_release);  // pairs with go_on
      }) {}

RTC::ReturnCode_t RTCPosition2d::onInitialize() {
  addVelocityPort();
  addInPort("pose_control", pose_in_);
  addInPort("heading_control", heading_in_);
  addInPort("carlike_control", car_in_);
  addInPort("path", path_in_);
  addOutPort("odometry", odometry_out_);
  addOutPort("actual_velocity", actual_velocity_out_);
  service_port().registerProvider("odometry", "RTC::Odometry2D", odometry_service_);
  service_port().registerProvider("velocity_control", "RTC::VelocityControl2D", velocity_service_);
  service_port().registerProvider("pose_control", "RTC::PoseControl2D", pose_service_);
  service_port().registerProvider("heading_control", "RTC::HeadingControl2D", heading_service_);
  service_port().registerProvider("carlike_control", "RTC::CarlikeControl", car_service_);
  service_port().registerProvider("path_follower", "RTC::PathFollower2D", path_follower_);
  bindDrive();
  return RTC::RTC_OK;
}

void RTCPosition2d::describe(const shm::Iface& robot) {
  DriveComponent::describe(robot);
  const auto& info = robot_ = robot.info<shm::Position2dInfo>();
  odometry_service_.describe(iface::to_geometry(info.pose, info.size));
  const RTC::Geometry2D geometry = iface::to_geometry_2d(info.pose, info.size);
  velocity_service_.describe(geometry);
  pose_service_.describe(geometry);
  heading_service_.describe(geometry);
  car_service_.describe(geometry);
}

void RTCPosition2d::detaching() {
  goal_ = {};
  DriveComponent::detaching();
}

void RTCPosition2d::command(const shm::PlanarPose& velocity) {
  const double values[] = {velocity.x, velocity.y, velocity.a};
  commanding_client().received(values);  // in real time it drives
  if (iface::in_simulated_time()) commanding_client().drive(values);
}

void RTCPosition2d::give_up() {
  if (std::holds_alternative<std::monostate>(goal_)) return;
  goal_ = {};
  commanding_client().stop();
}

// Values that are no numbers are ignored with a line: the robot goes on as before.
void RTCPosition2d::read_goals() {
  read_car();
  read_path();
  bool has_pose = false, has_heading = false;
  while (pose_in_.isNew()) has_pose = pose_in_.read() || has_pose;
  while (heading_in_.isNew()) has_heading = heading_in_.read() || has_heading;
  if (has_heading) {
    const auto& [speed, angle] = heading_.data;
    if (std::isfinite(speed) && std::isfinite(angle)) {
      goal_ = Heading{speed, angle};
      resets_.reset();
      command({speed, 0, 0});  // counts as a velocity: command_timeout stops the robot when no more come
    } else {
      RTC_WARN(("heading_control: expected finite numbers, got %g m/s and %g rad; ignored", speed, angle));
    }
  }
  if (has_pose) {
    const auto& [position, angle] = pose_.data;
    if (robot_.drive == RTMSIM_DRIVE_CAR) {
      RTC_WARN(("pose_control: a car cannot turn on the spot; ignored"));
    } else if (std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(angle)) {
      goal_ = shm::PoseControl({position.x, position.y, angle}, shm::within({}, robot_));
      resets_.reset();
    } else {
      RTC_WARN(("pose_control: expected finite numbers, got %g m, %g m and %g rad; ignored", position.x, position.y, angle));
    }
  }
}

void RTCPosition2d::read_car() {
  bool has_car = false;
  while (car_in_.isNew()) has_car = car_in_.read() || has_car;
  if (!has_car) return;
  if (robot_.drive != RTMSIM_DRIVE_CAR) {
    RTC_WARN(("carlike_control: the drive is not steered; ignored"));
    return;
  }
  const double values[] = {car_.data.speed, car_.data.steeringAngle};
  goal_ = {};
  commanding_client().received(values, shm::CommandKind::car);  // in real time it drives
  if (iface::in_simulated_time()) commanding_client().drive(values, shm::CommandKind::car);
}

void RTCPosition2d::read_path() {
  bool has_path = false;
  while (path_in_.isNew()) has_path = path_in_.read() || has_path;
  if (has_path && !path_follower_.set(path_.waypoints)) RTC_WARN(("path: expected finite numbers and at most 10000 way points; ignored"));
  if (!path_follower_.take_news()) return;
  if (robot_.drive == RTMSIM_DRIVE_CAR) {
    RTC_WARN(("path: a car cannot turn on the spot; ignored"));
    path_follower_.end();
    return;
  }
  give_up();
  goal_ = Following{};
  resets_.reset();
}

void RTCPosition2d::go_on(const shm::Position2dInfo& robot, const shm::Position2dSample& sample) {
  const bool was_set = was_odometry_set_.exchange(false, std::memory_order_acquire);  // pairs with SetOdometry
  if (was_set || resets_.value_or(sample.stamp.resets) != sample.stamp.resets) give_up();
  resets_ = sample.stamp.resets;
  const shm::PlanarPose odometry{sample.odometry[0], sample.odometry[1], sample.odometry[2]};
  if (auto* way = std::get_if<shm::PoseControl>(&goal_)) {
    command(way->next(odometry));
    if (way->has_arrived()) goal_ = {};
  } else if (const auto* heading = std::get_if<Heading>(&goal_)) {
    const double velocity[] = {heading->speed, 0, shm::turn_towards(odometry.a, heading->angle, shm::within({}, robot))};
    commanding_client().drive(velocity);
  }
  if (!std::holds_alternative<Following>(goal_)) return path_follower_.end();
  const auto velocity = path_follower_.next(odometry, robot);
  command(velocity.value_or(shm::PlanarPose{}));
  if (!velocity) goal_ = {};
}

void RTCPosition2d::publish(const shm::Iface& robot) {
  const auto& sample = robot.sample<shm::Position2dSample>();
  go_on(robot.info<shm::Position2dInfo>(), sample);
  odometry_.tm = iface::to_time(sample.stamp.sim_time_ns);
  odometry_.data.position.x = sample.odometry[0];
  odometry_.data.position.y = sample.odometry[1];
  odometry_.data.heading = sample.odometry[2];
  odometry_out_.write();
  actual_velocity_.tm = odometry_.tm;
  actual_velocity_.data.vx = sample.velocity[0];
  actual_velocity_.data.vy = sample.velocity[1];
  actual_velocity_.data.va = sample.velocity[2];
  actual_velocity_out_.write();
}

extern "C" {
void RTCPosition2dInit(RTC::Manager* manager) { iface::register_type<RTCPosition2d>(manager, specification); }
}

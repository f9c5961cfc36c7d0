#include "rtc_position2d.h"

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
      odometry_out_("odometry", odometry_),
      actual_velocity_out_("actual_velocity", actual_velocity_),
      odometry_service_([this](const RTC::Pose2D& pose) {
        shm::ResetOdometryRequest request;
        request.x = pose.position.x, request.y = pose.position.y, request.a = pose.heading;
        set_odometry(std::move(request));
      }) {}

RTC::ReturnCode_t RTCPosition2d::onInitialize() {
  addVelocityPort();
  addOutPort("odometry", odometry_out_);
  addOutPort("actual_velocity", actual_velocity_out_);
  service_port().registerProvider("odometry", "RTC::Odometry2D", odometry_service_);
  service_port().registerProvider("velocity_control", "RTC::VelocityControl2D", velocity_service_);
  bindDrive();
  return RTC::RTC_OK;
}

void RTCPosition2d::describe(const shm::Iface& robot) {
  DriveComponent::describe(robot);
  const auto& info = robot.info<shm::Position2dInfo>();
  odometry_service_.describe(iface::to_geometry(info.pose, info.size));
  velocity_service_.describe(iface::to_geometry_2d(info.pose, info.size));
}

void RTCPosition2d::publish(const shm::Iface& robot) {
  const auto& sample = robot.sample<shm::Position2dSample>();
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

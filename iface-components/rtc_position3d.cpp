#include "rtc_position3d.h"

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
      pose_out_("pose", pose_),
      actual_velocity_out_("actual_velocity", actual_velocity_),
      odometry_service_([this](const RTC::Pose3D& pose) {
        const auto& [at, turn] = pose;
        shm::ResetOdometryRequest request;
        request.is_3d = true;
        request.pose = shm::euler_pose(at.x, at.y, at.z, turn.r, turn.p, turn.y);
        set_odometry(std::move(request));
      }) {}

RTC::ReturnCode_t RTCPosition3d::onInitialize() {
  addVelocityPort();
  addOutPort("pose", pose_out_);
  addOutPort("actual_velocity", actual_velocity_out_);
  service_port().registerProvider("odometry", "RTC::Odometry3D", odometry_service_);
  service_port().registerProvider("velocity_control", "RTC::VelocityControl3D", velocity_service_);
  bindDrive();
  return RTC::RTC_OK;
}

void RTCPosition3d::describe(const shm::Iface& robot) {
  DriveComponent::describe(robot);
  const auto& info = robot.info<shm::Position3dInfo>();
  odometry_service_.describe(iface::to_geometry(info.pose, info.size));
  velocity_service_.describe(iface::to_geometry(info.pose, info.size));
}

void RTCPosition3d::publish(const shm::Iface& robot) {
  const auto& sample = robot.sample<shm::Position3dSample>();
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

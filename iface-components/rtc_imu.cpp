#include "rtc_imu.h"

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCImu",
    .description = "Inertial measurement unit of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::imu",
};

RTCImu::RTCImu(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::imu, true),
      orientation_out_("orientation", orientation_),
      angular_velocity_out_("angular_velocity", angular_velocity_),
      acceleration_out_("acceleration", acceleration_),
      service_port_("imu") {}

RTC::ReturnCode_t RTCImu::onInitialize() {
  addOutPort("orientation", orientation_out_);
  addOutPort("angular_velocity", angular_velocity_out_);
  addOutPort("acceleration", acceleration_out_);
  service_port_.registerProvider("imu", "RTC::IMU", service_);
  addPort(service_port_);
  bindDevice();
  return RTC::RTC_OK;
}

void RTCImu::describe(const shm::Iface& imu) { service_.describe(iface::to_geometry(imu.info<shm::ImuInfo>().pose)); }

void RTCImu::publish(const shm::Iface& imu) {
  const auto& sample = imu.sample<shm::ImuSample>();
  const auto& q = sample.orientation;
  orientation_.tm = angular_velocity_.tm = acceleration_.tm = iface::to_time(sample.stamp.sim_time_ns);
  orientation_.data = iface::to_orientation({0, 0, 0, q[0], q[1], q[2], q[3]});
  angular_velocity_.data = {sample.angular_velocity[0], sample.angular_velocity[1], sample.angular_velocity[2]};
  acceleration_.data = {sample.acceleration[0], sample.acceleration[1], sample.acceleration[2]};
  orientation_out_.write();
  angular_velocity_out_.write();
  acceleration_out_.write();
}

extern "C" {
void RTCImuInit(RTC::Manager* manager) { iface::register_type<RTCImu>(manager, specification); }
}

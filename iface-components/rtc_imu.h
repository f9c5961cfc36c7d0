// RTCImu: bridges an imu iface to three OutPorts, as there is no standard type for all of it: `orientation` (RTC::TimedOrientation3D),
// `angular_velocity` (RTC::TimedAngularVelocity3D, sensor frame), `acceleration` (RTC::TimedAcceleration3D: specific force, sensor frame).
// Service port `imu` (RTC::IMU). Configuration: server_id, device_id.
#pragma once

#include <rtm/ext/IMUSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include "geometry_service.h"
#include "iface_component.h"

class RTCImu : public iface::IfaceComponent {
 public:
  explicit RTCImu(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void describe(const shm::Iface& imu) override;
  void publish(const shm::Iface& imu) override;

 private:
  RTC::TimedOrientation3D orientation_;
  RTC::OutPort<RTC::TimedOrientation3D> orientation_out_;
  RTC::TimedAngularVelocity3D angular_velocity_;
  RTC::OutPort<RTC::TimedAngularVelocity3D> angular_velocity_out_;
  RTC::TimedAcceleration3D acceleration_;
  RTC::OutPort<RTC::TimedAcceleration3D> acceleration_out_;
  RTC::CorbaPort service_port_;
  iface::GeometryService<POA_RTC::IMU> service_;
};

extern "C" {
DLL_EXPORT void RTCImuInit(RTC::Manager* manager);
}

// RTCImu: bridges an imu iface to three OutPorts, as there is no standard type for all of it: `orientation` (RTC::TimedOrientation3D),
// `angular_velocity` (RTC::TimedAngularVelocity3D, sensor frame), `acceleration` (RTC::TimedAcceleration3D: specific force, sensor frame).
// Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/ExtendedDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include "iface_component.h"

class RTCImu : public iface::IfaceComponent {
 public:
  explicit RTCImu(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  RTC::TimedOrientation3D orientation_;
  RTC::OutPort<RTC::TimedOrientation3D> orientation_out_;
  RTC::TimedAngularVelocity3D angular_velocity_;
  RTC::OutPort<RTC::TimedAngularVelocity3D> angular_velocity_out_;
  RTC::TimedAcceleration3D acceleration_;
  RTC::OutPort<RTC::TimedAcceleration3D> acceleration_out_;
};

extern "C" {
DLL_EXPORT void RTCImuInit(RTC::Manager* manager);
}

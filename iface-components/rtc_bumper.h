// RTCBumper: bridges a bumper iface to the OutPorts `contact` (RTC::TimedBooleanSeq of one: touched) and `force` (RTC::TimedDoubleSeq: x y
// z [N] of each contact, world frame). The standard types have geometries of bumpers, but no data. Service port `bumper` (RTC::Bumper).
// Configuration: server_id, device_id.
#pragma once

#include <rtm/ext/BumperSkel.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include "geometry_service.h"
#include "iface_component.h"

class RTCBumper : public iface::IfaceComponent {
 public:
  explicit RTCBumper(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void describe(const shm::Iface& bumper) override;
  void publish(const shm::Iface& bumper) override;

 private:
  RTC::TimedBooleanSeq contact_;
  RTC::OutPort<RTC::TimedBooleanSeq> contact_out_;
  RTC::TimedDoubleSeq force_;
  RTC::OutPort<RTC::TimedDoubleSeq> force_out_;
  RTC::CorbaPort service_port_;
  iface::GeometryService<POA_RTC::Bumper, RTC::BumperGeometry> service_;
};

extern "C" {
DLL_EXPORT void RTCBumperInit(RTC::Manager* manager);
}

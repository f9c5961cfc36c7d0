// RTCBumper: bridges a bumper iface to the OutPorts `contact` (RTC::TimedBooleanSeq of one: touched) and `force` (RTC::TimedDoubleSeq: x y
// z [N] of each contact, world frame). The standard types have geometries of bumpers, but no data. Service port `bumper` (RTC::Bumper,
// RTC::DIO: its contact as the only bit, which cannot be set).
// Configuration: server_id, device_id.
#pragma once

#include <rtm/ext/BumperSkel.h>
#include <rtm/ext/DIOSkel.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include <atomic>

#include "geometry_service.h"
#include "iface_component.h"

// A bit that there is not: CORBA::BAD_PARAM. Any thread.
class ContactBit : public virtual POA_RTC::DIO, public virtual PortableServer::RefCountServantBase {
 public:
  CORBA::UShort NumBits() override { return 1; }
  CORBA::Boolean GetBit(CORBA::UShort index) override;
  void SetBit(CORBA::UShort index, CORBA::Boolean value) override;
  void show(bool is_set) { is_set_.store(is_set, std::memory_order_relaxed); }

 private:
  std::atomic<bool> is_set_{false};
};

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
  ContactBit bit_;
};

extern "C" {
DLL_EXPORT void RTCBumperInit(RTC::Manager* manager);
}

// RTCSonar: bridges a sonar iface to the OutPort `range` (RTC::RangeData); where each transducer sits and looks is in elementGeometries.
// Configuration: server_id, device_id.
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include "ranger_component.h"

class RTCSonar : public iface::RangerComponent {
 public:
  explicit RTCSonar(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void describe(const shm::Iface& sonar) override;
  void publish(const shm::Iface& sonar) override;

 private:
  RTC::RangeData range_;
  RTC::OutPort<RTC::RangeData> range_out_;
};

extern "C" {
DLL_EXPORT void RTCSonarInit(RTC::Manager* manager);
}

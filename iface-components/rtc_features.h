// RTCFeatures: finds lines and corners in the scans of a laser iface (scan_features.h) and sends them to the OutPort `features`
// (RTC::Features, frame of the scanner). Configuration: server_id, device_id; distance, gap and points of a line.
#pragma once

#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/DataOutPort.h>

#include <vector>

#include "iface_component.h"
#include "scan_features.h"

class RTCFeatures : public iface::IfaceComponent {
 public:
  explicit RTCFeatures(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;

 private:
  RTC::Features features_;
  RTC::OutPort<RTC::Features> features_out_;
  iface::FeatureLimits limits_;
  std::vector<iface::ScanPoint> points_;
};

extern "C" {
DLL_EXPORT void RTCFeaturesInit(RTC::Manager* manager);
}

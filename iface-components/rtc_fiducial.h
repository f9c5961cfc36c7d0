// RTCFiducial: bridges a fiducial iface to the OutPort `fiducials` (RTC::Fiducials: id, pose in the detector with its standard deviations,
// size; an empty list is sent, too). A mark's x axis points out of its face, z is its up. Service port `fiducial` (RTC::Fiducial); SetFOV
// cuts what is sent to a part of the detector's own field of view. Configuration: server_id, device_id.
#pragma once

#include <rtm/ext/FiducialSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include "geometry_service.h"
#include "iface_component.h"

// Calls from any thread.
class FiducialService : public iface::GeometryService<POA_RTC::Fiducial> {
 public:
  // The detector's own field of view, until SetFOV.
  void describe(const shm::FiducialInfo& info);
  RTC::FiducialFOV GetFOV() override { return state_.lock()->wanted; }
  // What is no field of view, or wider than the detector's own, is cut to that.
  void SetFOV(const RTC::FiducialFOV& wanted) override;

 private:
  struct State {
    RTC::FiducialFOV own{0, 0, 0}, wanted{0, 0, 0};
  };
  base::Guarded<State, base::Rank::details> state_;
};

class RTCFiducial : public iface::IfaceComponent {
 public:
  explicit RTCFiducial(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void describe(const shm::Iface& detector) override { service_.describe(detector.info<shm::FiducialInfo>()); }
  void publish(const shm::Iface& detector) override;

 private:
  RTC::Fiducials fiducials_;
  RTC::OutPort<RTC::Fiducials> fiducials_out_;
  RTC::CorbaPort service_port_;
  FiducialService service_;
};

extern "C" {
DLL_EXPORT void RTCFiducialInit(RTC::Manager* manager);
}

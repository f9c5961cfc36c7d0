// RTCMulticamera: bridges the cameras of a multicamera sensor to the OutPort `images` (RTC::MultiCameraImages): an image of each camera,
// all of the same simulated time. Formats are those of RTCCamera (docs/cameras.md). Service port `multicamera` (RTC::Multicamera): pose of
// each camera on the model and its parameters (focal length and principal point in pixels); the baseline of a pair is the difference of the
// poses. Configuration: server_id; device_id: the sensor, MODEL::SENSOR; cameras: their names with commas between, in the order that is
// sent; empty: all of the sensor by name.
#pragma once

#include <rtm/ext/MulticameraSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataOutPort.h>
#include <rtm/Manager.h>

#include <base/guarded.h>

#include <optional>
#include <string>
#include <vector>

#include "camera_image.h"
#include "iface_link.h"
#include "line_limit.h"
#include "specification.h"

// Calls from any thread.
class MulticameraService : public virtual POA_RTC::Multicamera, public virtual PortableServer::RefCountServantBase {
 public:
  void describe(const std::vector<shm::CameraInfo>& cameras);
  RTC::MulticameraGeometry* GetGeometry() override { return new RTC::MulticameraGeometry(state_.lock()->geometry); }
  RTC::MulticameraInfoList* GetCameraInfos() override { return new RTC::MulticameraInfoList(state_.lock()->infos); }

 private:
  struct State {
    RTC::MulticameraGeometry geometry;
    RTC::MulticameraInfoList infos;
  };
  base::Guarded<State, base::Rank::details> state_;
};

class RTCMulticamera : public RTC::DataFlowComponentBase {
 public:
  explicit RTCMulticamera(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onAborting(RTC::UniqueId ec_id) override;

 private:
  struct Eye {
    iface::IfaceLink link;
    std::optional<shm::HeldFrame> frame;  // the newest that has not been sent
    std::vector<std::byte> packed;
    std::uint64_t described = 0;
  };
  // What has been configured, in the order that is sent.
  std::vector<std::string> wanted() const;
  bool attach();
  void describe_when_new();
  // Whether all frames are of one time. Older ones are dropped.
  bool are_together();
  void send();

  int server_id_ = 0;
  std::string device_id_, cameras_;
  std::string attached_to_;  // the configuration of that
  std::vector<Eye> eyes_;
  iface::LineLimit limit_;  // of lines about cameras that are not there
  RTC::MultiCameraImages images_;
  RTC::OutPort<RTC::MultiCameraImages> images_out_;
  RTC::CorbaPort service_port_;
  MulticameraService service_;
};

extern "C" {
DLL_EXPORT void RTCMulticameraInit(RTC::Manager* manager);
}

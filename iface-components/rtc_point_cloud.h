// RTCPointCloud: bridges a laser iface, of any number of layers, to the OutPorts `points` (RTC::PointCloud; colour: the intensity in grey)
// and `cloud` (PointCloudTypes::PointCloud), each only when connected. Points in the sensor's frame: x forward, y left, z up [m]; layer by
// layer from the lowest, in each from right to left. Service port `point_cloud` (RTC::PointCloudServices).
// Configuration: server_id, device_id; organised: 1 keeps rays that hit nothing as NaN, so that `cloud` has a row for each layer; fields of
// `cloud`: xyz (12 bytes a point) or all (with intensity, ring and time since the first beam, 24 bytes; tm is that
// of the first beam).
#pragma once

#include <rtm/ext/PointCloudServicesSkel.h>
#include <rtm/ext/PointCloudTypesSkel.h>

#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include <string>
#include <vector>

#include "conversions.h"
#include "geometry_service.h"
#include "iface_component.h"

class RTCPointCloud : public iface::IfaceComponent {
 public:
  explicit RTCPointCloud(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void describe(const shm::Iface& laser) override;
  void publish(const shm::Iface& laser) override;

 private:
  void send_points(const std::vector<iface::RayPoint>& points);
  void send_cloud(const shm::LaserInfo& info, const std::vector<iface::RayPoint>& points);

  int organised_ = 0;
  std::string fields_ = "xyz";
  std::vector<iface::RayPoint> rays_;
  RTC::Time time_{};
  std::int64_t begin_ns_ = 0;  // of the first beam
  RTC::PointCloud points_;
  RTC::OutPort<RTC::PointCloud> points_out_;
  PointCloudTypes::PointCloud cloud_;
  RTC::OutPort<PointCloudTypes::PointCloud> cloud_out_;
  RTC::CorbaPort service_port_;
  iface::GeometryService<POA_RTC::PointCloudServices> service_;
};

extern "C" {
DLL_EXPORT void RTCPointCloudInit(RTC::Manager* manager);
}

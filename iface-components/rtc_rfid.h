// RTCRfid: bridges a rfid iface to the OutPort `tags` (RTC::TimedStringSeq: ids of the tags in reach, the nearest first). Service port
// `rfid` (RTC::RFID): Read gives the data of a tag of the last sample, Write changes it until a reset. Configuration: server_id, device_id.
#pragma once

#include <rtm/ext/RFIDSkel.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <base/guarded.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataOutPort.h>

#include <functional>
#include <map>
#include <string>

#include "async_requests.h"
#include "geometry_service.h"
#include "iface_component.h"

// A tag that was not in the last sample: CORBA::BAD_PARAM. Write returns at once; the simulator does it between two ticks, so it is read
// from the next sample on. Data are at most 127 bytes without zeros and line breaks, else CORBA::BAD_PARAM. Any thread.
class RfidService : public iface::GeometryService<POA_RTC::RFID> {
 public:
  using Send = std::function<void(const std::string& id, const std::string& data)>;
  explicit RfidService(Send send) : send_(std::move(send)) {}
  void Write(const char* id, const RTC::RFIDTagData& data) override;
  RTC::RFIDTagData* Read(const char* id) override;
  void set_tags(std::map<std::string, std::string> data_of) { *data_of_.lock() = std::move(data_of); }

 private:
  Send send_;
  base::Guarded<std::map<std::string, std::string>, base::Rank::details> data_of_;
};

class RTCRfid : public iface::IfaceComponent {
 public:
  explicit RTCRfid(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;

 protected:
  void publish(const shm::Iface& device) override;
  void describe(const shm::Iface& rfid) override;

 private:
  RTC::TimedStringSeq tags_;
  RTC::OutPort<RTC::TimedStringSeq> tags_out_;
  RTC::CorbaPort service_port_;
  iface::AsyncRequests async_requests_;
  base::Guarded<iface::Device, base::Rank::details> described_;  // whose tags are written
  RfidService service_;
};

extern "C" {
DLL_EXPORT void RTCRfidInit(RTC::Manager* manager);
}

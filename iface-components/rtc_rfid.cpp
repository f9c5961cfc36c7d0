#include "rtc_rfid.h"

#include <algorithm>

#include "conversions.h"
#include "specification.h"

static const iface::Specification specification{
    .type_name = "RTCRfid",
    .description = "Reader of RFID tags of a simulated robot",
    .phase = iface::sensor_phase,
    .device = "pioneer2dx::rfid",
};

RTCRfid::RTCRfid(RTC::Manager* manager)
    : IfaceComponent(manager, specification, shm::IfaceType::rfid, true),
      tags_out_("tags", tags_),
      service_port_("rfid"),
      async_requests_(say()),
      service_([this](const std::string& id, const std::string& data) {
        const iface::Device device = described_.snapshot();
        async_requests_.post(device.server_id, shm::WriteTagRequest{device.device_id, id, data});
      }) {}

RTC::ReturnCode_t RTCRfid::onInitialize() {
  addOutPort("tags", tags_out_);
  service_port_.registerProvider("rfid", "RTC::RFID", service_);
  addPort(service_port_);
  bindDevice();
  return RTC::RTC_OK;
}

void RfidService::Write(const char* id, const RTC::RFIDTagData& data) {
  constexpr std::size_t most = sizeof(shm::RfidTag::data) - 1;
  const std::string text(reinterpret_cast<const char*>(data.get_buffer()), data.length());
  constexpr std::string_view impossible("\n\0", 2);
  const bool is_there = data_of_.snapshot().contains(id);
  if (!is_there || text.size() > most || text.find_first_of(impossible) != std::string::npos) throw CORBA::BAD_PARAM();
  send_(id, text);
}

RTC::RFIDTagData* RfidService::Read(const char* id) {
  const auto tags = data_of_.snapshot();
  const auto found = tags.find(id);
  if (found == tags.end()) throw CORBA::BAD_PARAM();
  RTC::RFIDTagData_var data = new RTC::RFIDTagData;
  data->length(static_cast<CORBA::ULong>(found->second.size()));
  std::copy(found->second.begin(), found->second.end(), data->get_buffer());
  return data._retn();
}

void RTCRfid::describe(const shm::Iface& rfid) {
  *described_.lock() = link().device();
  service_.describe(iface::to_geometry(rfid.info<shm::RfidInfo>().pose));
}

void RTCRfid::publish(const shm::Iface& device) {
  const auto found = device.elements<shm::RfidTag>();
  std::map<std::string, std::string> data_of;
  tags_.tm = iface::to_time(device.sample<shm::RfidSample>().stamp.sim_time_ns);
  tags_.data.length(static_cast<CORBA::ULong>(found.size()));
  for (std::size_t i = 0; i < found.size(); ++i) {
    tags_.data[static_cast<CORBA::ULong>(i)] = found[i].id;
    data_of.emplace(found[i].id, found[i].data);
  }
  service_.set_tags(std::move(data_of));
  tags_out_.write();
}

extern "C" {
void RTCRfidInit(RTC::Manager* manager) { iface::register_type<RTCRfid>(manager, specification); }
}

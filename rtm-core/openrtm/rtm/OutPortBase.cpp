#include "rtm/OutPortBase.h"

#include "corba/out_engine.h"
#include "openrtm/data_port_support.h"

namespace RTC {

OutPortBase::OutPortBase(const char* name, const corba::TypeOps& type, const detail::Serializers& serializers)
    : DataPortBase(name, std::make_unique<corba::OutEngine>(type, [this](const std::string& id) { drop_connection(id.c_str()); }),
                   serializers) {}

OutPortBase::~OutPortBase() { retire(); }

void OutPortBase::retire() {
  engine_->stop_telling();
  shut();
}

bool OutPortBase::writeValue(const void* value) { return engine_->write(value); }

ReturnCode_t OutPortBase::prepare(ConnectorProfile& profile) {
  detail::share_port_properties(profile, m_properties);
  const auto settings = detail::settings_of(profile, m_properties, rt::Side::out).settings;
  if (engine_->connections()->size() >= settings.fan_out) {
    RTC_WARN_STR("connection refused: the port has " << settings.fan_out << " connections already, as many as dataport.fan_out allows");
    return RTC::RTC_ERROR;
  }
  return DataPortBase::prepare(profile);
}

}  // namespace RTC

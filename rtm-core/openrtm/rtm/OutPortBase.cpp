#include "rtm/OutPortBase.h"

#include "component/runtime_access.h"
#include "openrtm/data_port_core.h"
#include "openrtm/data_port_support.h"
#include "rtm/DataType.h"

namespace RTC {

OutPortBase::OutPortBase(const char* name, const detail::DataType& type, const detail::Serializers& serializers)
    : DataPortBase(name, std::make_unique<detail::DataPortCore>(
                             rt::Side::out,
                             corba::make_out_port(RuntimeAccess::ops(type), [this](const std::string& id) { drop_connection(id.c_str()); }),
                             serializers)) {}

OutPortBase::~OutPortBase() { retire(); }

void OutPortBase::retire() {
  core_->port().stop_telling();
  shut();
}

bool OutPortBase::writeValue(const void* value) { return core_->port().write(value); }

ReturnCode_t OutPortBase::prepare(ConnectorProfile& profile, const detail::PortTerms& terms) {
  detail::share_port_properties(profile, m_properties);
  const std::size_t most = static_cast<const detail::DataPortTerms&>(terms).outcome.settings.fan_out;
  if (core_->port().count() >= most) {
    detail::log_refused_connection(rtclog,
                                   "the port has " + std::to_string(most) + " connections already, as many as dataport.fan_out allows");
    return RTC::RTC_ERROR;
  }
  return DataPortBase::prepare(profile, terms);
}

}  // namespace RTC

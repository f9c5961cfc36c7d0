#include "rtm/InPortBase.h"

#include <algorithm>
#include <chrono>

#include "base/waiting.h"
#include "component/runtime_access.h"
#include "openrtm/data_port_core.h"
#include "rtm/DataType.h"
#include "rtm/Timestamp.h"

namespace RTC {

InPortBase::InPortBase(const char* name, const detail::DataType& type, const detail::Serializers& serializers)
    : DataPortBase(name, std::make_unique<detail::DataPortCore>(rt::Side::in, corba::make_in_port(RuntimeAccess::ops(type)), serializers)) {
}

InPortBase::~InPortBase() { retire(); }

void InPortBase::retire() { shut(); }

bool InPortBase::isNew() { return isNew(std::string()); }

bool InPortBase::isNew(const std::string& connector_name) {
  std::vector<std::string> lost;
  const bool is_new = core_->port().has_new(connector_name, lost);
  for (const auto& id : lost) drop_connection(id.c_str());
  return is_new;
}

bool InPortBase::isNew(coil::vstring& connector_names) {
  connector_names.clear();
  for (const auto& name : getConnectorNames()) {
    if (isNew(name)) connector_names.push_back(name);
  }
  return !connector_names.empty();
}

bool InPortBase::waitNew(double seconds) {
  if (isNew()) return true;
  if (inSimulatedTime() || !(seconds > 0)) return false;
  constexpr double longest = 1e6;
  const base::ScopedWait waiting;
  return core_->port().wait_new(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::duration<double>(std::min(seconds, longest))));
}

bool InPortBase::readValue(const std::string& connector_name, void* value) {
  std::vector<std::string> lost;
  const rt::PortStatus status = core_->port().read(connector_name, value, lost);
  for (const auto& id : lost) drop_connection(id.c_str());
  return status == rt::PortStatus::ok;
}

}  // namespace RTC

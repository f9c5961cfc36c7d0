// What the manager does with ports and states: preconnect, preactivation.
#include "base/text.h"
#include "core/preconnect.h"
#include "manager/manager_impl.h"
#include "rtm/CORBA_RTCUtil.h"
#include "rtm/NamingManager.h"

namespace RTC {

RTObject_var ManagerImpl::find_component(const std::string& name) {
  RTObject_var result;
  if (const auto local = held_component(name); local) {
    result = local->reference();
  } else if (naming) {
    const auto found = naming->string_to_component(name);
    if (found.length() > 0) result = RTObject::_duplicate(found[0]);
  }
  return result;
}

base::Result<void> ManagerImpl::connect(const std::string& text) {
  const auto request = rt::parse_connection(text);
  if (!request) return request.error();
  const auto find_port = [&](const rt::PortAddress& address) -> base::Result<PortService_var> {
    RTObject_var component = find_component(address.component);
    if (CORBA::is_nil(component)) return base::Error{"component " + base::in_quotes(address.component) + ": not found"};
    PortService_var port = CORBA_RTCUtil::get_port_by_name(component, address.port);
    if (CORBA::is_nil(port))
      return base::Error{"component " + base::in_quotes(address.component) + ": has no port " + base::in_quotes(address.port)};
    return port;
  };
  const auto complain = [&](const std::string& why) { return base::Error{"connection " + base::in_quotes(text) + ": " + why}; };
  const auto first = find_port(request->port);
  if (!first) return complain(first.error().message);
  coil::Properties properties;
  for (const auto& [key, setting] : request->properties) properties.setProperty("dataport." + key, setting);
  if (properties.getProperty("dataport.reconnect").empty()) properties.setProperty("dataport.reconnect", "YES");
  for (const auto& address : request->others) {
    const auto other = find_port(address);
    if (!other) return complain(other.error().message);
    const auto code = CORBA_RTCUtil::connect(request->name, properties, first->in(), other->in());
    if (code != RTC_OK) return complain("the ports rejected it, code " + std::to_string(static_cast<int>(code)));
  }
  return {};
}

base::Result<void> ManagerImpl::activate_component(const std::string& name) {
  RTObject_var component = find_component(name);
  if (CORBA::is_nil(component)) return base::Error{"activation: component " + base::in_quotes(name) + ": not found"};
  const auto code = CORBA_RTCUtil::activate(component, 0);
  if (code != RTC_OK)
    return base::Error{"activation of " + base::in_quotes(name) + " failed, code " + std::to_string(static_cast<int>(code))};
  return {};
}

// What the configuration names is complained about with the place where it does.
std::string ManagerImpl::where_if(const std::string& text, const std::string& key) const {
  return text == value(key) ? where(key) : std::string();
}

void Manager::connectPorts(const std::string& preconnect) {
  const auto where = impl_->where_if(preconnect, "manager.components.preconnect");
  for (const auto& request : base::split_list(preconnect)) {
    if (auto connected = impl_->connect(request); !connected) impl_->report(where + connected.error().message);
  }
}

void Manager::activateComponents(const std::string& preactivation) {
  const auto where = impl_->where_if(preactivation, "manager.components.preactivation");
  for (const auto& name : base::split_list(preactivation)) {
    if (auto activated = impl_->activate_component(name); !activated) impl_->report(where + activated.error().message);
  }
}

}  // namespace RTC

// The ports of a component.
#include <rtm/InPortBase.h>
#include <rtm/NVUtil.h>
#include <rtm/OutPortBase.h>
#include <rtm/PortBase.h>
#include "component/component_impl.h"

#include <algorithm>

#include "component/runtime_access.h"

namespace RTC {

std::string RTObject_impl::portNameOf(const std::string& name) const {
  const auto turn = impl_->properties_turn.take();
  return profile_.instance_name + "." + name;
}

bool RTObject_impl::addPort(Port port) {
  if (port.local) {
    // What was said for all ports of the kind, then what was said for this one.
    const char* kind = port.in ? "inport" : port.out ? "outport" : "corbaport";
    const std::string for_all = port.in || port.out ? std::string("port.") + kind + ".dataport" : "port.corba";
    coil::Properties properties;
    {
      const auto turn = impl_->properties_turn.take();
      if (const coil::Properties* node = m_properties.findNode(for_all)) properties << *node;
      if (const coil::Properties* node = m_properties.findNode(std::string("port.") + kind + "." + port.name)) properties << *node;
    }
    RTObject_var self = getObjRef();
    port.local->setName(portNameOf(port.name).c_str());
    port.local->setOwner(self);
    port.local->init(properties);
    port.local->setPortConnectListenerHolder(&m_portconnListeners);
    if (port.in) RuntimeAccess::set_clock(*port.in, impl_->clock);
    if (port.out) RuntimeAccess::set_clock(*port.out, impl_->clock);
    port.reference = PortService::_duplicate(port.local->getPortRef());
  }
  PortProfile profile;
  if (port.local) {
    profile = port.local->getPortProfile();
  } else {
    PortProfile_var asked = port.reference->get_port_profile();
    profile = asked;
    port.name = profile.name;
  }
  bool is_active = false;
  {
    auto data = impl_->shared.lock();
    for (const Port& known : data->ports)
      if (known.name == port.name) return false;
    data->ports.push_back(port);
    is_active = !data->active_in.empty();
  }
  if (is_active && port.local) port.local->activateInterfaces();
  m_actionListeners.portaction_[ADD_PORT].notify(profile);
  return true;
}

bool RTObject_impl::addPort(PortBase& port) {
  Port entry;
  entry.name = port.getName();
  entry.local = &port;
  entry.in = dynamic_cast<InPortBase*>(&port);
  entry.out = dynamic_cast<OutPortBase*>(&port);
  return addPort(std::move(entry));
}

bool RTObject_impl::addPort(PortService_ptr port) {
  if (CORBA::is_nil(port)) return false;
  Port entry;
  entry.reference = PortService::_duplicate(port);
  try {
    return addPort(std::move(entry));
  } catch (const CORBA::Exception&) {
    RTC_ERROR(("a port that is to be added does not answer"));
    return false;
  }
}

bool RTObject_impl::addInPort(const char* name, InPortBase& inport) {
  Port entry;
  entry.name = name;
  entry.local = &inport;
  entry.in = &inport;
  return addPort(std::move(entry));
}

bool RTObject_impl::addOutPort(const char* name, OutPortBase& outport) {
  Port entry;
  entry.name = name;
  entry.local = &outport;
  entry.out = &outport;
  return addPort(std::move(entry));
}

namespace {

// Returns what the port was. Nobody can reach it any more.
PortProfile withdrawPort(PortBase& port) {
  port.disconnect_all();
  const PortProfile profile = port.getPortProfile();
  port.deactivateInterfaces();
  port.setPortConnectListenerHolder(nullptr);
  port.deactivate();
  return profile;
}

}  // namespace

bool RTObject_impl::removePort(const Port& port) {
  PortProfile profile;
  if (port.local) {
    profile = withdrawPort(*port.local);
  } else {
    profile.name = port.name.c_str();
    profile.port_ref = PortService::_duplicate(port.reference);
  }
  m_actionListeners.portaction_[REMOVE_PORT].notify(profile);
  return true;
}

namespace {

// Takes the first entry that fits out of the list.
template <class List, class Fits>
bool take(List& list, Fits fits, typename List::value_type& taken) {
  const auto it = std::find_if(list.begin(), list.end(), fits);
  if (it == list.end()) return false;
  taken = *it;
  list.erase(it);
  return true;
}

}  // namespace

bool RTObject_impl::removePort(PortBase& port) {
  Port taken;
  if (!take(
          impl_->shared.lock()->ports, [&](const Port& entry) { return entry.local == &port; }, taken))
    return false;
  return removePort(taken);
}

bool RTObject_impl::removeInPort(InPortBase& port) { return removePort(static_cast<PortBase&>(port)); }
bool RTObject_impl::removeOutPort(OutPortBase& port) { return removePort(static_cast<PortBase&>(port)); }

bool RTObject_impl::removePort(PortService_ptr port) {
  if (CORBA::is_nil(port)) return false;
  Port taken;
  if (!take(
          impl_->shared.lock()->ports, [&](const Port& entry) { return entry.reference->_is_equivalent(port); }, taken))
    return false;
  return removePort(taken);
}

void RTObject_impl::deletePortByName(const char* port_name) {
  const std::string name = port_name ? port_name : "";
  Port taken;
  if (!take(
          impl_->shared.lock()->ports, [&](const Port& entry) { return entry.name == name || portNameOf(entry.name) == name; }, taken))
    return;
  removePort(taken);
}

// May be called again. Listeners hear of ports that are removed from a component that lives, not of those that end with it.
void RTObject_impl::finalizePorts() {
  std::vector<Port> ports;
  ports.swap(impl_->shared.lock()->ports);
  for (const Port& port : ports)
    if (port.local) withdrawPort(*port.local);
}

void RTObject_impl::activatePorts(UniqueId exec_handle) {
  std::vector<Port> ports;
  {
    auto data = impl_->shared.lock();
    const bool was_active = !data->active_in.empty();
    data->active_in.insert(exec_handle);
    if (was_active) return;
    ports = data->ports;
  }
  for (const Port& port : ports)
    if (port.local) port.local->activateInterfaces();
}

void RTObject_impl::deactivatePorts(UniqueId exec_handle) {
  std::vector<Port> ports;
  {
    auto data = impl_->shared.lock();
    if (data->active_in.erase(exec_handle) == 0 || !data->active_in.empty()) return;
    ports = data->ports;
  }
  for (const Port& port : ports)
    if (port.local) port.local->deactivateInterfaces();
}

PortServiceList* RTObject_impl::get_ports() {
  PortServiceList_var list = new PortServiceList();
  auto data = impl_->shared.lock();
  list->length(static_cast<CORBA::ULong>(data->ports.size()));
  for (CORBA::ULong i = 0; i < list->length(); ++i) list[i] = PortService::_duplicate(data->ports[i].reference);
  return list._retn();
}

std::vector<InPortBase*> RTObject_impl::getInPorts() const {
  std::vector<InPortBase*> ports;
  auto data = impl_->shared.lock();
  for (const Port& port : data->ports)
    if (port.in) ports.push_back(port.in);
  return ports;
}

std::vector<OutPortBase*> RTObject_impl::getOutPorts() const {
  std::vector<OutPortBase*> ports;
  auto data = impl_->shared.lock();
  for (const Port& port : data->ports)
    if (port.out) ports.push_back(port.out);
  return ports;
}

std::vector<PortBase*> RTObject_impl::getLocalPorts() const {
  std::vector<PortBase*> ports;
  auto data = impl_->shared.lock();
  for (const Port& port : data->ports)
    if (port.local) ports.push_back(port.local);
  return ports;
}

bool RTObject_impl::readAll() {
  const bool goes_on = impl_->shared.lock()->reads_on;
  bool all = true;
  for (InPortBase* port : getInPorts()) {
    if (port->read()) continue;
    all = false;
    if (!goes_on) return false;
  }
  return all;
}

bool RTObject_impl::writeAll() {
  const bool goes_on = impl_->shared.lock()->writes_on;
  bool all = true;
  for (OutPortBase* port : getOutPorts()) {
    if (port->write()) continue;
    all = false;
    if (!goes_on) return false;
  }
  return all;
}

void RTObject_impl::setReadAll(bool read, bool completion) {
  auto data = impl_->shared.lock();
  data->reads_all = read;
  data->reads_on = completion;
}

void RTObject_impl::setWriteAll(bool write, bool completion) {
  auto data = impl_->shared.lock();
  data->writes_all = write;
  data->writes_on = completion;
}

}  // namespace RTC

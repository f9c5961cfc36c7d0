// What tests of components share: a probe that is finalized at the end, and servants that are taken down.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/probe_component.h"

namespace support {

// A component that is finalized and given back at the end.
template <class Component = ProbeComponent>
class Owned {
 public:
  template <class... Args>
  explicit Owned(Args&&... args) : component_(new Component(std::forward<Args>(args)...)) {}
  ~Owned() {
    component_->exit();
    component_->_remove_ref();
  }
  Owned(const Owned&) = delete;
  Owned& operator=(const Owned&) = delete;
  Component* operator->() { return component_; }
  Component& operator*() { return *component_; }

 private:
  Component* component_;
};

// A servant that is active while this lives.
template <class Servant>
class Served {
 public:
  template <class... Args>
  explicit Served(Args&&... args) : servant_(new Servant(std::forward<Args>(args)...)), reference_(servant_->_this()) {}
  ~Served() {
    PortableServer::POA_var poa = servant_->_default_POA();
    PortableServer::ObjectId_var id = poa->reference_to_id(reference_);
    poa->deactivate_object(id);
    servant_->_remove_ref();
  }
  Served(const Served&) = delete;
  Served& operator=(const Served&) = delete;
  Servant* operator->() { return servant_; }
  CORBA::Object_ptr reference() { return reference_; }

 private:
  Servant* servant_;
  CORBA::Object_var reference_;
};

// A new reference.
inline RTC::ExecutionContext_ptr first_context(RTC::RTObject_impl& component) { return component.getExecutionContext(0); }

inline SDOPackage::ServiceProfile service_profile(const char* id, const char* type, CORBA::Object_ptr service,
                                                  const std::vector<std::pair<std::string, std::string>>& properties = {}) {
  SDOPackage::ServiceProfile profile;
  profile.id = id;
  profile.interface_type = type;
  profile.service = SDOPackage::SDOService::_narrow(service);
  for (const auto& [name, value] : properties) {
    const CORBA::ULong n = profile.properties.length();
    profile.properties.length(n + 1);
    profile.properties[n].name = name.c_str();
    profile.properties[n].value <<= value.c_str();
  }
  return profile;
}

struct ComponentTest : testing::Test {
  void set(const std::string& name, const std::string& value) {
    coil::Properties values("default");
    values[name] = value;
    probe->getConfigService().setConfigurationSetValues(values);
    probe->getConfigService().activateConfigurationSet("default");
  }
  RTC::LifeCycleState state() {
    RTC::ExecutionContext_var context = first_context(*probe);
    RTC::RTObject_var self = probe->getObjRef();
    return context->get_component_state(self);
  }
  Owned<> probe;
};

}  // namespace support

// The Configuration object of a component: servant of SDOPackage::Configuration. Any thread.
#pragma once

#include <rtm/idl/SDOPackageSkel.h>

#include <memory>

namespace RTC {
class ConfigAdmin;
class RTObject_impl;
class SdoServiceAdmin;
}  // namespace RTC

namespace SDOPackage {

class Configuration_impl : public virtual POA_SDOPackage::Configuration, public virtual PortableServer::RefCountServantBase {
 public:
  // The three must live until close().
  Configuration_impl(RTC::RTObject_impl& component, RTC::ConfigAdmin& configuration, RTC::SdoServiceAdmin& services);
  ~Configuration_impl() override;

  // After return nobody uses the component through this object; callers get OBJECT_NOT_EXIST.
  void close();

  CORBA::Boolean set_device_profile(const DeviceProfile& profile) override;
  CORBA::Boolean add_service_profile(const ServiceProfile& profile) override;
  CORBA::Boolean add_organization(Organization_ptr organization) override;
  CORBA::Boolean remove_service_profile(const char* id) override;
  CORBA::Boolean remove_organization(const char* organization_id) override;
  // Parameters are reached by sets; these four answer as OpenRTM does: nothing, and true.
  ParameterList* get_configuration_parameters() override;
  NVList* get_configuration_parameter_values() override;
  CORBA::Any* get_configuration_parameter_value(const char* name) override;
  CORBA::Boolean set_configuration_parameter(const char* name, const CORBA::Any& value) override;
  ConfigurationSetList* get_configuration_sets() override;
  ConfigurationSet* get_configuration_set(const char* id) override;
  CORBA::Boolean set_configuration_set_values(const ConfigurationSet& set) override;
  ConfigurationSet* get_active_configuration_set() override;
  CORBA::Boolean add_configuration_set(const ConfigurationSet& set) override;
  CORBA::Boolean remove_configuration_set(const char* id) override;
  CORBA::Boolean activate_configuration_set(const char* id) override;

 private:
  struct Door;

  const std::unique_ptr<Door> door_;
  RTC::RTObject_impl& component_;
  RTC::ConfigAdmin& configuration_;
  RTC::SdoServiceAdmin& services_;
};

}  // namespace SDOPackage

#include "rtm/PeriodicECSharedComposite.h"

#include <coil/stringutil.h>
#include <rtm/Factory.h>
#include <rtm/Manager.h>
#include <rtm/NamingManager.h>
#include <rtm/PeriodicECOrganization.h>

#include "base/text.h"

namespace RTC {

namespace {

const char* const composite_spec[] = {"implementation_id",
                                      "PeriodicECSharedComposite",
                                      "type_name",
                                      "PeriodicECSharedComposite",
                                      "description",
                                      "PeriodicECSharedComposite",
                                      "version",
                                      "1.0",
                                      "vendor",
                                      "rtm-sim",
                                      "category",
                                      "composite.PeriodicECShared",
                                      "activity_type",
                                      "DataFlowComponent",
                                      "max_instance",
                                      "0",
                                      "language",
                                      "C++",
                                      "lang_type",
                                      "compile",
                                      "exported_ports",
                                      "",
                                      "conf.default.members",
                                      "",
                                      "conf.default.exported_ports",
                                      "",
                                      ""};

// Exported ports follow the active configuration set at once: tools look for them after activate_configuration_set.
class ActivationListener final : public ConfigurationSetNameListener {
 public:
  ActivationListener(ConfigAdmin& configuration, SDOPackage::PeriodicECOrganization& organization)
      : configuration_(configuration), organization_(organization) {}
  void operator()(const char* set) override {
    const coil::Properties values = configuration_.getConfigurationSet(set);
    if (values.hasKey("exported_ports")) organization_.export_ports(values.getProperty("exported_ports"));
  }

 private:
  ConfigAdmin& configuration_;
  SDOPackage::PeriodicECOrganization& organization_;
};

// Tools that set the active set expect the ports without activating it.
class SetListener final : public ConfigurationSetListener {
 public:
  SetListener(ConfigAdmin& configuration, SDOPackage::PeriodicECOrganization& organization)
      : configuration_(configuration), organization_(organization) {}
  void operator()(const coil::Properties& set) override {
    if (configuration_.getActiveId() == std::string(set.getName()) && set.hasKey("exported_ports"))
      organization_.export_ports(set.getProperty("exported_ports"));
  }

 private:
  ConfigAdmin& configuration_;
  SDOPackage::PeriodicECOrganization& organization_;
};

}  // namespace

PeriodicECSharedComposite::PeriodicECSharedComposite(Manager* manager) : DataFlowComponentBase(manager) {
  organization_ = new SDOPackage::PeriodicECOrganization(*this);
  addOwnedOrganization(organization_);
  bindParameter("members", members_, "");
}

PeriodicECSharedComposite::~PeriodicECSharedComposite() { organization_->_remove_ref(); }

ReturnCode_t PeriodicECSharedComposite::onInitialize() {
  addConfigurationSetNameListener(ON_ACTIVATE_CONFIG_SET, new ActivationListener(m_configsets, *organization_));
  addConfigurationSetListener(ON_SET_CONFIG_SET, new SetListener(m_configsets, *organization_));
  m_configsets.update("default");
  SDOPackage::SDOList sdos;
  for (const std::string& name : base::split_list(base::join(members_, "|"), '|')) {  // both separators; see MultilayerCompositeEC
    // Of this process by name, of others by address.
    NamingManager* naming = m_pManager ? m_pManager->getNaming() : nullptr;
    const RTCList found = naming ? naming->string_to_component(name) : RTCList();
    if (found.length() == 0) {
      RTC_ERROR(("no component %s that could be a member", base::in_quotes(name).c_str()));
      continue;
    }
    const CORBA::ULong n = sdos.length();
    sdos.length(n + 1);
    sdos[n] = SDOPackage::SDO::_duplicate(found[0]);
  }
  std::string ports = m_configsets.getConfigurationSet("default").getProperty("exported_ports");
  if (ports.empty()) ports = property("exported_ports");
  organization_->export_ports(ports);
  try {
    organization_->add_members(sdos);
  } catch (const SDOPackage::InvalidParameter& exception) {
    RTC_ERROR(("a component does not become a member: %s", exception.description.in()));
  }
  return RTC_OK;
}

ReturnCode_t PeriodicECSharedComposite::onActivated(RTC::UniqueId) {
  organization_->activate_members();
  return RTC_OK;
}

ReturnCode_t PeriodicECSharedComposite::onDeactivated(RTC::UniqueId) {
  organization_->deactivate_members();
  return RTC_OK;
}

ReturnCode_t PeriodicECSharedComposite::onReset(RTC::UniqueId) {
  organization_->reset_members();
  return RTC_OK;
}

ReturnCode_t PeriodicECSharedComposite::onFinalize() {
  organization_->close();
  return RTC_OK;
}

}  // namespace RTC

extern "C" void PeriodicECSharedCompositeInit(RTC::Manager* manager) {
  coil::Properties profile(RTC::composite_spec);
  manager->registerFactory(profile, RTC::Create<RTC::PeriodicECSharedComposite>, RTC::Delete<RTC::PeriodicECSharedComposite>);
}

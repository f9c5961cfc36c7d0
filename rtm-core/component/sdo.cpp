// A component as an SDO: organizations, services, device profile, status.
#include "component/component_impl.h"

#include "base/text.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/orb.h"
#include "corba/orb/principal.h"

namespace RTC {

SDOPackage::OrganizationList* RTObject_impl::get_owned_organizations() {
  std::vector<SDOPackage::Organization_impl*> owned;
  {
    auto data = impl_->shared.lock();
    owned = data->owned_organizations;
    for (auto* organization : owned) organization->_add_ref();
  }
  SDOPackage::OrganizationList_var list = new SDOPackage::OrganizationList();
  list->length(static_cast<CORBA::ULong>(owned.size()));
  for (CORBA::ULong i = 0; i < list->length(); ++i) {
    list[i] = owned[i]->getObjRef();
    owned[i]->_remove_ref();
  }
  return list._retn();
}

char* RTObject_impl::get_sdo_id() {
  const auto turn = impl_->properties_turn.take();
  return CORBA::string_dup(profile_.instance_name.c_str());
}

char* RTObject_impl::get_sdo_type() {
  const auto turn = impl_->properties_turn.take();
  return CORBA::string_dup(profile_.description.c_str());
}

SDOPackage::DeviceProfile* RTObject_impl::get_device_profile() { return new SDOPackage::DeviceProfile(getDeviceProfile()); }
SDOPackage::DeviceProfile RTObject_impl::getDeviceProfile() const { return impl_->shared.lock()->device; }
void RTObject_impl::setDeviceProfile(const SDOPackage::DeviceProfile& profile) { impl_->shared.lock()->device = profile; }

SDOPackage::ServiceProfileList* RTObject_impl::get_service_profiles() { return impl_->services.getServiceProviderProfiles(); }

SDOPackage::ServiceProfile* RTObject_impl::get_service_profile(const char* id) {
  if (id[0] == '\0') throw SDOPackage::InvalidParameter("the id is empty");
  SDOPackage::ServiceProfile* profile = impl_->services.getServiceProviderProfile(id);
  if (!profile) throw SDOPackage::InvalidParameter(("no SDO service " + base::in_quotes(id)).c_str());
  return profile;
}

SDOPackage::SDOService_ptr RTObject_impl::get_sdo_service(const char* id) {
  SDOPackage::ServiceProfile_var profile = get_service_profile(id);
  return SDOPackage::SDOService::_duplicate(profile->service);
}

SDOPackage::Configuration_ptr RTObject_impl::get_configuration() {
  const SDOPackage::Configuration_var configuration = impl_->shared.lock()->configuration_reference;
  if (CORBA::is_nil(configuration)) throw SDOPackage::NotAvailable("the component is finalized");
  return SDOPackage::Configuration::_duplicate(configuration);
}

SDOPackage::Monitoring_ptr RTObject_impl::get_monitoring() { throw SDOPackage::InterfaceNotImplemented("monitoring is not implemented"); }

SDOPackage::OrganizationList* RTObject_impl::get_organizations() {
  SDOPackage::OrganizationList_var list = new SDOPackage::OrganizationList();
  auto data = impl_->shared.lock();
  list->length(static_cast<CORBA::ULong>(data->organizations.size()));
  for (CORBA::ULong i = 0; i < list->length(); ++i) list[i] = SDOPackage::Organization::_duplicate(data->organizations[i]);
  return list._retn();
}

// No component has a status of this kind; contexts and observers tell what there is to tell.
SDOPackage::NVList* RTObject_impl::get_status_list() { return new SDOPackage::NVList(); }

CORBA::Any* RTObject_impl::get_status(const char* name) {
  throw SDOPackage::InvalidParameter(("no status " + base::in_quotes(name)).c_str());
}

bool RTObject_impl::addOrganization(SDOPackage::Organization_ptr organization) {
  if (CORBA::is_nil(organization) || !corba::may_keep(organization)) return false;
  {
    auto data = impl_->shared.lock();
    for (const SDOPackage::Organization_var& known : data->organizations)
      if (SDOPackage::Organization_var(known)->_is_equivalent(organization)) return true;
    if (data->organizations.size() < max_memberships) {
      data->organizations.push_back(SDOPackage::Organization::_duplicate(organization));
      return true;
    }
  }
  rt::log_rejection(rtclog, Logger::RTL_ERROR,
                    "a further organization is rejected: the component is in " + std::to_string(max_memberships) + ", the maximum");
  return false;
}

bool RTObject_impl::removeOrganization(const char* organization_id) {
  std::vector<SDOPackage::Organization_var> organizations = impl_->shared.lock()->organizations;
  const corba::ChainDeadline deadline(corba::port_call_timeout());
  for (SDOPackage::Organization_var& organization : organizations) {
    if (deadline.is_over()) return false;
    try {
      deadline.limit(organization);
      CORBA::String_var id = organization->get_organization_id();
      if (std::string(id) != organization_id) continue;
    } catch (const CORBA::Exception&) {
      continue;  // one that is gone has no id to compare
    }
    auto data = impl_->shared.lock();
    return std::erase_if(data->organizations, [&](const SDOPackage::Organization_var& known) {
             return SDOPackage::Organization_var(known)->_is_equivalent(organization);
           }) > 0;
  }
  return false;
}

void RTObject_impl::addOwnedOrganization(SDOPackage::Organization_impl* organization) {
  organization->_add_ref();
  impl_->shared.lock()->owned_organizations.push_back(organization);
}

bool RTObject_impl::addSdoServiceProvider(const SDOPackage::ServiceProfile& prof, SdoServiceProviderBase* provider) {
  return impl_->services.addSdoServiceProvider(prof, provider);
}
bool RTObject_impl::removeSdoServiceProvider(const char* id) { return impl_->services.removeSdoServiceProvider(id ? id : ""); }
bool RTObject_impl::addSdoServiceConsumer(const SDOPackage::ServiceProfile& prof) { return impl_->services.addSdoServiceConsumer(prof); }
bool RTObject_impl::removeSdoServiceConsumer(const char* id) { return impl_->services.removeSdoServiceConsumer(id ? id : ""); }

}  // namespace RTC

#include "component/fsm_service.h"

#include <rtm/RTObject.h>

namespace RTC {

ExtendedFsmServiceProvider::ExtendedFsmServiceProvider(std::function<std::string()> current_state, const FsmStructure& structure) {
  auto data = shared_.lock();
  data->current_state = std::move(current_state);
  data->structure = structure;
}

ExtendedFsmServiceProvider* ExtendedFsmServiceProvider::offer(RTObject_impl& component, std::function<std::string()> current_state,
                                                              const FsmStructure& structure) {
  auto* provider = new ExtendedFsmServiceProvider(std::move(current_state), structure);
  SDOPackage::ServiceProfile profile;
  profile.id = interface_id;
  profile.interface_type = interface_id;
  RTC::ExtendedFsmService_var reference = provider->POA_RTC::ExtendedFsmService::_this();
  profile.service = SDOPackage::SDOService::_duplicate(reference);
  provider->init(component, profile);
  if (component.addSdoServiceProvider(profile, provider)) return provider;
  provider->finalize();
  try {
    PortableServer::POA_var poa = provider->_default_POA();
    PortableServer::ObjectId_var id = poa->reference_to_id(reference);
    poa->deactivate_object(id);
  } catch (const CORBA::Exception&) {
    // There is no object adapter any more.
  }
  provider->_remove_ref();
  return nullptr;
}

char* ExtendedFsmServiceProvider::get_current_state() {
  const corba::Gate::Visit visit(gate_);
  if (!visit) throw CORBA::OBJECT_NOT_EXIST();
  const auto current_state = shared_.lock()->current_state;
  return CORBA::string_dup(current_state ? current_state().c_str() : "");
}

ReturnCode_t ExtendedFsmServiceProvider::set_fsm_structure(const FsmStructure& fsm_structure) {
  const corba::Gate::Visit visit(gate_);
  if (!visit) throw CORBA::OBJECT_NOT_EXIST();
  RTObject_impl* component = nullptr;
  {
    auto data = shared_.lock();
    if (std::string(fsm_structure.name) != data->structure.name.in()) return BAD_PARAMETER;
    data->structure = fsm_structure;
    component = data->component;
  }
  if (component) component->notifyObservers(RTObject_impl::Status::fsm_structure, fsm_structure.name.in());
  return RTC_OK;
}

ReturnCode_t ExtendedFsmServiceProvider::get_fsm_structure(FsmStructure_out fsm_structure) {
  fsm_structure = new FsmStructure(shared_.lock()->structure);
  return RTC_OK;
}

bool ExtendedFsmServiceProvider::init(RTObject_impl& component, const SDOPackage::ServiceProfile& profile) {
  shared_.lock()->component = &component;
  profile_ = profile;
  return true;
}

bool ExtendedFsmServiceProvider::reinit(const SDOPackage::ServiceProfile& profile) {
  profile_ = profile;
  return true;
}

void ExtendedFsmServiceProvider::finalize() { gate_.close(); }

}  // namespace RTC

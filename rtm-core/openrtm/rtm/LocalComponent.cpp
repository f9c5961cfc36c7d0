#include <rtm/LocalComponent.h>
#include <rtm/RTObject.h>

namespace RTC {

namespace {

std::shared_ptr<RTObject_impl> find_in(PortableServer::POA_ptr poa, CORBA::Object_ptr object) {
  if (CORBA::is_nil(poa)) return nullptr;
  try {
    PortableServer::Servant servant = poa->reference_to_servant(object);
    if (auto* component = dynamic_cast<RTObject_impl*>(servant)) return {component, [](RTObject_impl* counted) { counted->_remove_ref(); }};
    servant->_remove_ref();
  } catch (const CORBA::Exception&) {
    // Not of this adapter: the normal case for components of other processes.
  }
  return nullptr;
}

}  // namespace

std::shared_ptr<RTObject_impl> findLocalComponent(CORBA::Object_ptr object) {
  if (CORBA::is_nil(object)) return nullptr;
  PortableServer::POA_var root = PortableServer::POA::_the_root_poa();
  return find_in(root, object);
}

}  // namespace RTC

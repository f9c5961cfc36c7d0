#include "component/local_component.h"
#include <rtm/ExecutionContextBase.h>
#include <rtm/RTObject.h>

#include "corba/orb/orb.h"

namespace RTC {

namespace {

template <class Wanted>
std::shared_ptr<Wanted> find(CORBA::Object_ptr object) {
  if (CORBA::is_nil(object)) return nullptr;
  PortableServer::POA_var root = PortableServer::POA::_the_root_poa();
  if (CORBA::is_nil(root)) return nullptr;
  try {
    PortableServer::Servant servant = root->reference_to_servant(object);
    if (auto* wanted = dynamic_cast<Wanted*>(servant)) return {wanted, [servant](Wanted*) { servant->_remove_ref(); }};
    servant->_remove_ref();
  } catch (const CORBA::Exception&) {
    // Not of this adapter: the normal case for objects of other processes.
  }
  const CORBA::Object_var published = corba::published_object(object);
  return CORBA::is_nil(published) ? nullptr : find<Wanted>(published);
}

}  // namespace

std::shared_ptr<RTObject_impl> findLocalComponent(CORBA::Object_ptr object) { return find<RTObject_impl>(object); }
std::shared_ptr<ExecutionContextBase> findLocalContext(CORBA::Object_ptr object) { return find<ExecutionContextBase>(object); }

}  // namespace RTC

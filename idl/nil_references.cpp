// The nil references of omniORB's own interfaces: see cmake/nil_references.cmake.
#include <omniORB4/CORBA.h>
#include <omniORB4/Naming.hh>

namespace {

[[maybe_unused]] const bool nil_references_are_made = [] {
  CORBA::Object::_nil();
  CORBA::LocalObject::_nil();
  CORBA::ORB::_nil();
  CORBA::Policy::_nil();
  CORBA::Current::_nil();
  PortableServer::POA::_nil();
  PortableServer::POAManager::_nil();
  PortableServer::Current::_nil();
  PortableServer::AdapterActivator::_nil();
  PortableServer::ServantManager::_nil();
  PortableServer::ServantActivator::_nil();
  PortableServer::ServantLocator::_nil();
  CosNaming::NamingContext::_nil();
  CosNaming::NamingContextExt::_nil();
  CosNaming::BindingIterator::_nil();
  return true;
}();

}  // namespace

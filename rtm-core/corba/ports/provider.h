// A servant that is active as long as this lives. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include "corba/transport/transport.h"

namespace corba {

// Stub: the interface as callers know it.
template <class Stub>
class ActiveServant final : public Provider {
 public:
  // Takes over the one reference of a new servant. Throws CORBA::Exception if it cannot be activated.
  explicit ActiveServant(PortableServer::ServantBase* servant) : poa_(servant->_default_POA()) {
    try {
      id_ = poa_->activate_object(servant);
      reference_ = poa_->id_to_reference(id_);
    } catch (...) {
      servant->_remove_ref();
      throw;
    }
    servant->_remove_ref();
  }
  ~ActiveServant() override {
    try {
      poa_->deactivate_object(id_);
    } catch (const CORBA::Exception&) {
      // The POA is gone already, and the servant with it.
    }
  }
  CORBA::Object_ptr reference() const override { return reference_.in(); }
  CORBA::Any as_any() const override {
    const typename Stub::_var_type stub = Stub::_unchecked_narrow(reference_);
    CORBA::Any any;
    any <<= stub.in();
    return any;
  }

 private:
  PortableServer::POA_var poa_;
  PortableServer::ObjectId_var id_;
  CORBA::Object_var reference_;
};

}  // namespace corba

// Calls of CORBA objects by the descriptors of the stubs, and servants whose operations are methods of Python objects.
//
// Rights: arguments and results are coded with the interpreter's lock, which is not held while a call waits. Failure cases: a value that
// does not fit is CORBA.BAD_PARAM and names its place; a method that raises anything but a CORBA exception is CORBA.UNKNOWN for the
// caller, and its traceback is logged here.
#pragma once

#include <omniORB4/CORBA.h>
#include <pybind11/pybind11.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gil.h"
#include "references.h"
#include "types.h"

namespace python {

// What a stub knows of an operation.
struct Operation {
  std::vector<const Type*> ins, outs;
  bool is_oneway = false;
  std::map<std::string, const Type*> exceptions{};
  std::vector<const char*> exception_names{};
};

// nullptr with a Python exception. Kept for ever.
const Operation* operation_of(PyObject* descriptor);

// An exception of IDL on its way through the ORB; its Python object.
class UserRaised final : public CORBA::UserException {
 public:
  UserRaised(PyObject* exception, const Type& type) : type_(&type), exception_(std::make_shared<Kept>(exception)) {}
  UserRaised(const UserRaised& other) : CORBA::UserException(other), type_(other.type_), exception_(other.exception_) {}
  PyObject* get() const { return exception_->get(); }
  void _raise() const override { throw *this; }
  const char* _NP_repoId(int* size) const override;
  void _NP_marshal(cdrStream& stream) const override;
  CORBA::Exception* _NP_duplicate() const override { return new UserRaised(*this); }
  const char* _NP_typeId() const override { return "Exception/UserException/UserRaised"; }

 private:
  const Type* type_;
  std::shared_ptr<Kept> exception_;
};

// Sets the Python exception that stands for one of the ORB.
void set_python_exception(const CORBA::SystemException& problem);

// Sets the Python exception for one of an IDL file and throws; the operation knows the ones of C++.
[[noreturn]] void raise_user(const CORBA::UserException& problem, const Operation* operation);

// Runs a call of the ORB without the lock; its exceptions become those of Python.
template <class Call>
auto asked(Call call, const Operation* operation = nullptr) {
  try {
    return unlocked(call);
  } catch (const CORBA::SystemException& problem) {
    set_python_exception(problem);
  } catch (const CORBA::UserException& problem) {
    raise_user(problem, operation);
  } catch (const omniORB::fatalException& problem) {
    PyErr_SetString(PyExc_RuntimeError, problem.errmsg());
  }
  throw pybind11::error_already_set();
}

// The result of an operation of a reference; throws error_already_set.
pybind11::object invoke(const ObjRef& self, const std::string& name, const pybind11::object& descriptor, const pybind11::tuple& arguments);

class Servant final : public PortableServer::ServantBase {
 public:
  Servant(const pybind11::object& self, const pybind11::dict& operations, std::vector<std::string> ids);

  // With the interpreter's lock.
  void forget_self() { self_ = nullptr; }
  void leave() {}
  PyObject* self() const { return self_; }
  // The object adapter may call it from now on: the Python object stays.
  void keep_self();
  // Where it is active; nil before that. With the interpreter's lock.
  PortableServer::POA_ptr adapter() const { return adapter_.in(); }
  void set_adapter(PortableServer::POA_ptr adapter) { adapter_ = PortableServer::POA::_duplicate(adapter); }

  CORBA::Boolean _dispatch(omniCallHandle& handle) override;
  const char* _mostDerivedRepoId() override { return ids_.empty() ? "IDL:omg.org/CORBA/Object:1.0" : ids_.front().c_str(); }
  CORBA::Boolean _is_a(const char* id) override;
  // Stubs of C++ in this process go by the wire's way, too.
  void* _ptrToInterface(const char*) override { return nullptr; }

 private:
  PyObject* self_;
  bool is_kept_ = false;
  PortableServer::POA_var adapter_;
  const std::vector<std::string> ids_;
  std::map<std::string, const Operation*> operations_;
};

}  // namespace python

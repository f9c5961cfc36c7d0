#include "calls.h"

#include <omniORB4/IOP_C.h>
#include <omniORB4/callDescriptor.h>
#include <omniORB4/callHandle.h>
#include <omniORB4/minorCode.h>
#include <pybind11/stl.h>
#include <rtm/SystemLogger.h>

#include <cstring>
#include <unordered_map>

#include "coder.h"
#include "complaint.h"
#include "component.h"
#include "references.h"

namespace py = pybind11;

namespace python {
namespace {

bool read_types(PyObject* descriptors, std::vector<const Type*>& types) {
  if (!PyTuple_Check(descriptors)) return false;
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(descriptors); ++i) {
    types.push_back(type_of(PyTuple_GET_ITEM(descriptors, i)));
    if (!types.back()) return false;
  }
  return true;
}

bool read_exceptions(PyObject* exceptions, Operation& operation) {
  if (exceptions == Py_None) return true;
  if (!PyDict_Check(exceptions)) return false;
  PyObject *key = nullptr, *value = nullptr;
  Py_ssize_t at = 0;
  while (PyDict_Next(exceptions, &at, &key, &value)) {
    const char* id = PyUnicode_Check(key) ? PyUnicode_AsUTF8(key) : nullptr;
    const Type* type = id ? type_of(value) : nullptr;
    if (!type) return false;
    operation.exceptions[id] = type;
  }
  for (const auto& [id, type] : operation.exceptions) operation.exception_names.push_back(id.c_str());
  return true;
}

// Callers of other processes decide how often.
void log_error(const std::string& text) {
  static auto& complaint = *new Complaint;
  std::optional<std::string> line;
  {
    const Locked locked;
    line = complaint.each(text);
  }
  if (line) RTC::Logger("service").write(RTC::Logger::RTL_ERROR, *line);
}

// Encodes with the lock; a value that does not fit is BAD_PARAM with a log line.
void put_values(const std::vector<const Type*>& types, PyObject* values, cdrStream& stream, std::string& problem) {
  const Locked locked;
  for (std::size_t i = 0; i < types.size(); ++i) {
    try {
      encode(*types[i], PyTuple_GET_ITEM(values, static_cast<Py_ssize_t>(i)), stream);
    } catch (const BadValue& bad) {
      problem = "value " + std::to_string(i + 1) + ": " + bad.text();
      throw CORBA::BAD_PARAM();
    } catch (const PythonFailed&) {
      problem = take_error();
      throw CORBA::BAD_PARAM();
    }
  }
}

Ref get_values(const std::vector<const Type*>& types, cdrStream& stream) {
  Ref values(PyTuple_New(static_cast<Py_ssize_t>(types.size())));
  for (std::size_t i = 0; i < types.size(); ++i) {
    try {
      PyTuple_SET_ITEM(values.get(), static_cast<Py_ssize_t>(i), decode(*types[i], stream));
    } catch (const BadOctets&) {
      throw CORBA::MARSHAL();
    } catch (const PythonFailed&) {
      PyErr_Clear();
      throw CORBA::MARSHAL();
    }
  }
  return values;
}

// --- the caller's side

class ClientCall final : public omniCallDescriptor {
 public:
  ClientCall(const std::string& name, const Operation& operation, PyObject* arguments)
      : omniCallDescriptor(nullptr, name.c_str(), name.size() + 1, operation.is_oneway, operation.exception_names.data(),
                           static_cast<int>(operation.exception_names.size()), false),
        operation_(operation),
        arguments_(arguments) {}
  void marshalArguments(cdrStream& stream) override { put_values(operation_.ins, arguments_, stream, problem_); }
  void unmarshalReturnedValues(cdrStream& stream) override {
    const Locked locked;
    results_ = get_values(operation_.outs, stream);
  }
  void userException(cdrStream& stream, omni::IOP_C* iop_client, const char* id) override {
    const auto known = operation_.exceptions.find(id);
    if (known == operation_.exceptions.end()) {
      if (iop_client) iop_client->RequestCompleted(true);
      throw CORBA::UNKNOWN(omni::UNKNOWN_UserException, CORBA::COMPLETED_MAYBE);
    }
    const Locked locked;
    const Ref exception(get_values({known->second}, stream));
    if (iop_client) iop_client->RequestCompleted();
    throw UserRaised(PyTuple_GET_ITEM(exception.get(), 0), *known->second);
  }
  const std::string& problem() const { return problem_; }
  // None, the one value, or the tuple.
  py::object result() {
    const Py_ssize_t count = results_ ? PyTuple_GET_SIZE(results_.get()) : 0;
    if (count == 0) return py::none();
    if (count == 1) return py::reinterpret_borrow<py::object>(PyTuple_GET_ITEM(results_.get(), 0));
    return py::reinterpret_borrow<py::object>(results_.get());
  }

 private:
  const Operation& operation_;
  PyObject* const arguments_;
  Ref results_;
  std::string problem_;
};

}  // namespace

void raise_user(const CORBA::UserException& problem, const Operation* operation) {
  int size = 0;
  const char* id = problem._NP_repoId(&size);
  if (const auto* own = dynamic_cast<const UserRaised*>(&problem)) {
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(own->get())), own->get());
    throw py::error_already_set();
  }
  // One of C++ in this process.
  const auto known = operation ? operation->exceptions.find(id) : std::map<std::string, const Type*>::const_iterator();
  if (operation && known != operation->exceptions.end()) {
    cdrMemoryStream stream;
    problem._NP_marshal(stream);
    const Ref exception(get_values({known->second}, stream));
    PyObject* const one = PyTuple_GET_ITEM(exception.get(), 0);
    PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(one)), one);
    throw py::error_already_set();
  }
  set_python_exception(CORBA::UNKNOWN(omni::UNKNOWN_UserException, CORBA::COMPLETED_MAYBE));
  throw py::error_already_set();
}

py::object invoke(const ObjRef& self, const std::string& name, const py::object& descriptor, const py::tuple& arguments) {
  const Operation* operation = operation_of(descriptor.ptr());
  if (!operation) throw py::error_already_set();
  if (arguments.size() != operation->ins.size()) {
    throw py::type_error(name + "() takes " + std::to_string(operation->ins.size()) + " arguments, got " +
                         std::to_string(arguments.size()));
  }
  ClientCall call(name, *operation, arguments.ptr());
  try {
    asked([&] { self.object->_PR_getobj()->_invoke(call); }, operation);
  } catch (py::error_already_set& error) {
    if (!call.problem().empty()) {
      static PyObject* const bad = of_module("omniORB.CORBA", "BAD_PARAM");
      static PyObject* const no = of_module("omniORB.CORBA", "COMPLETED_NO");
      const Ref made(PyObject_CallFunction(bad, "iOs", 0, no, (name + ": " + call.problem()).c_str()));
      PyErr_SetObject(bad, made.get());
      throw py::error_already_set();
    }
    throw;
  }
  return call.result();
}

namespace {

// --- the servant's side

class Upcall final : public omniCallDescriptor {
 public:
  Upcall(const char* name, const Operation& operation, PyObject* self)
      : omniCallDescriptor(&call_local, name, std::strlen(name) + 1, operation.is_oneway, operation.exception_names.data(),
                           static_cast<int>(operation.exception_names.size()), true),
        operation_(operation),
        self_(self) {}
  void unmarshalArguments(cdrStream& stream) override {
    const Locked locked;
    arguments_ = std::make_unique<Kept>(get_values(operation_.ins, stream).get());
  }
  void marshalReturnedValues(cdrStream& stream) override {
    std::string problem;
    if (results_) put_values(operation_.outs, results_->get(), stream, problem);
  }

 private:
  static void call_local(omniCallDescriptor* descriptor, omniServant*) { static_cast<Upcall*>(descriptor)->run(); }

  void run() {
    std::string problem;
    try {
      const Locked locked;
      problem = run_locked();
    } catch (const CORBA::Exception&) {
      throw;
    }
    if (problem.empty()) return;
    log_error(std::string(op()) + " of a service: " + problem);
    throw CORBA::UNKNOWN(0, CORBA::COMPLETED_MAYBE);
  }

  std::string run_locked() {
    const Ref method(PyObject_GetAttrString(self_.get(), op()));
    const Ref result(method ? PyObject_Call(method.get(), arguments_->get(), nullptr) : nullptr);
    if (!result) return raised();
    if (operation_.is_oneway) return {};
    const std::size_t count = operation_.outs.size();
    Ref results;
    if (count > 1) {
      if (!PyTuple_Check(result.get()) || static_cast<std::size_t>(PyTuple_GET_SIZE(result.get())) != count)
        return "it must return a tuple of " + std::to_string(count) + " values";
      results = result;
    } else {
      results = Ref(PyTuple_New(static_cast<Py_ssize_t>(count)));
      if (count) PyTuple_SET_ITEM(results.get(), 0, Py_NewRef(result.get()));
    }
    // What cannot be encoded must be found before the reply begins.
    cdrMemoryStream trial;
    std::string problem;
    try {
      put_values(operation_.outs, results.get(), trial, problem);
    } catch (const CORBA::SystemException&) {
      return "its result cannot be sent: " + problem;
    }
    results_ = std::make_unique<Kept>(results.get());
    return {};
  }

  // Throws the CORBA exception that is set; else its text.
  std::string raised() {
    // Modules are imported without an exception that is set.
    PyObject *set_type = nullptr, *set_value = nullptr, *set_trace = nullptr;
    PyErr_Fetch(&set_type, &set_value, &set_trace);
    static PyObject* const user = of_module("omniORB.CORBA", "UserException");
    static PyObject* const system = of_module("omniORB.CORBA", "SystemException");
    PyErr_Restore(set_type, set_value, set_trace);
    if (user && PyErr_ExceptionMatches(user)) {
      PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
      PyErr_Fetch(&type, &value, &trace);
      PyErr_NormalizeException(&type, &value, &trace);
      const Ref owned_type(type), owned_value(value), owned_trace(trace);
      const Ref id(PyObject_GetAttrString(value, "_NP_RepositoryId"));
      const char* text = id && PyUnicode_Check(id.get()) ? PyUnicode_AsUTF8(id.get()) : nullptr;
      const auto known = text ? operation_.exceptions.find(text) : operation_.exceptions.end();
      PyErr_Clear();
      if (known != operation_.exceptions.end()) throw UserRaised(value, *known->second);
      return std::string("it raised ") + (text ? text : "an exception") + ", which its IDL does not name";
    }
    if (system && PyErr_ExceptionMatches(system)) throw_system();
    return take_error();
  }

  [[noreturn]] void throw_system() {
    PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
    PyErr_Fetch(&type, &value, &trace);
    PyErr_NormalizeException(&type, &value, &trace);
    const Ref owned_type(type), owned_value(value), owned_trace(trace);
    const std::string name = Py_TYPE(value)->tp_name;
    const Ref minor(PyObject_GetAttrString(value, "minor"));
    const auto number = minor && PyLong_Check(minor.get()) ? static_cast<CORBA::ULong>(PyLong_AsUnsignedLong(minor.get())) : 0;
    PyErr_Clear();
    const auto is = [&](const char* one) { return name == one || name.ends_with(std::string(".") + one); };
    if (is("NO_IMPLEMENT")) throw CORBA::NO_IMPLEMENT(number, CORBA::COMPLETED_NO);
    if (is("BAD_PARAM")) throw CORBA::BAD_PARAM(number, CORBA::COMPLETED_MAYBE);
    if (is("BAD_OPERATION")) throw CORBA::BAD_OPERATION(number, CORBA::COMPLETED_MAYBE);
    if (is("OBJECT_NOT_EXIST")) throw CORBA::OBJECT_NOT_EXIST(number, CORBA::COMPLETED_NO);
    if (is("NO_PERMISSION")) throw CORBA::NO_PERMISSION(number, CORBA::COMPLETED_NO);
    if (is("TRANSIENT")) throw CORBA::TRANSIENT(number, CORBA::COMPLETED_NO);
    if (is("COMM_FAILURE")) throw CORBA::COMM_FAILURE(number, CORBA::COMPLETED_MAYBE);
    if (is("TIMEOUT")) throw CORBA::TIMEOUT(number, CORBA::COMPLETED_MAYBE);
    if (is("INTERNAL")) throw CORBA::INTERNAL(number, CORBA::COMPLETED_MAYBE);
    if (is("MARSHAL")) throw CORBA::MARSHAL(number, CORBA::COMPLETED_MAYBE);
    if (is("BAD_INV_ORDER")) throw CORBA::BAD_INV_ORDER(number, CORBA::COMPLETED_MAYBE);
    throw CORBA::UNKNOWN(number, CORBA::COMPLETED_MAYBE);
  }

  const Operation& operation_;
  Kept self_;
  std::unique_ptr<Kept> arguments_, results_;
};

}  // namespace

const char* UserRaised::_NP_repoId(int* size) const {
  *size = static_cast<int>(type_->id.size()) + 1;
  return type_->id.c_str();
}

void UserRaised::_NP_marshal(cdrStream& stream) const {
  const Locked locked;
  try {
    encode(*type_, get(), stream);
  } catch (const BadValue&) {
    throw CORBA::MARSHAL();
  } catch (const PythonFailed&) {
    PyErr_Clear();
    throw CORBA::MARSHAL();
  }
}

void set_python_exception(const CORBA::SystemException& problem) {
  static PyObject* const codes = [] {
    const Ref all(of_module("omniORB.CORBA", "completion_status"));
    return all ? PyObject_GetAttrString(all.get(), "_items") : nullptr;
  }();
  PyObject* const cls = of_module("omniORB.CORBA", problem._name());
  if (!cls || !codes) return;
  const auto completed = static_cast<Py_ssize_t>(problem.completed());
  const bool is_held = problem.minor() == omni::TIMEOUT_CallTimedOutOnServer && CORBA::TIMEOUT::_downcast(&problem);
  const char* why = is_held ? "TIMEOUT_CallTimedOutOnServer: its POAManager is not active; call its activate()" : problem.NP_minorString();
  const Ref made(PyObject_CallFunction(cls, "IOs", problem.minor(), PyTuple_GET_ITEM(codes, completed < 3 ? completed : 0), why));
  if (made) PyErr_SetObject(cls, made.get());
}

const Operation* operation_of(PyObject* descriptor) {
  static auto& known = *new std::unordered_map<PyObject*, const Operation*>;
  if (const auto found = known.find(descriptor); found != known.end()) return found->second;
  auto* operation = new Operation;
  const bool is_tuple = PyTuple_Check(descriptor) && PyTuple_GET_SIZE(descriptor) >= 3;
  if (is_tuple) {
    PyObject* const outs = PyTuple_GET_ITEM(descriptor, 1);
    operation->is_oneway = outs == Py_None;
    if (read_types(PyTuple_GET_ITEM(descriptor, 0), operation->ins) && (operation->is_oneway || read_types(outs, operation->outs)) &&
        read_exceptions(PyTuple_GET_ITEM(descriptor, 2), *operation)) {
      Py_INCREF(descriptor);
      return known[descriptor] = operation;
    }
  }
  delete operation;
  if (!PyErr_Occurred()) PyErr_SetString(PyExc_TypeError, "this is no descriptor of an operation");
  return nullptr;
}

// --- references

std::optional<CORBA::Object_var> reference_in(PyObject* stub) {
  if (stub == Py_None) return CORBA::Object_var(CORBA::Object::_nil());
  const Ref object(PyObject_GetAttrString(stub, "_obj"));
  if (!object) {
    PyErr_Clear();
    return std::nullopt;
  }
  const py::handle handle(object.get());
  if (!py::isinstance<ObjRef>(handle)) return std::nullopt;
  return py::cast<const ObjRef&>(handle).object;
}

PyObject* reference_out(CORBA::Object_ptr object, const char* id) {
  if (CORBA::is_nil(object)) return Py_NewRef(Py_None);
  PyObject* cls = registered("objrefMapping", object->_PR_getobj()->_mostDerivedRepoId());
  PyObject* const asked_for = id && *id ? registered("objrefMapping", id) : nullptr;
  if (cls && asked_for && PyObject_IsSubclass(cls, asked_for) != 1) cls = asked_for;
  if (!cls) cls = asked_for ? asked_for : registered("objrefMapping", "");
  try {
    const py::object made = py::cast(new ObjRef{CORBA::Object::_duplicate(object)}, py::return_value_policy::take_ownership);
    // Not by a call: the stubs of omniidl 3 take no argument.
    auto* const type = reinterpret_cast<PyTypeObject*>(cls);
    static PyObject* const nothing = PyTuple_New(0);
    Ref stub(type->tp_new(type, nothing, nullptr));
    if (!stub || PyObject_SetAttrString(stub.get(), "_obj", made.ptr()) != 0) return nullptr;
    return stub.release();
  } catch (py::error_already_set& error) {
    error.restore();
    return nullptr;
  }
}

// --- servants

Servant::Servant(const py::object& self, const py::dict& operations, std::vector<std::string> ids)
    : self_(self.ptr()), ids_(std::move(ids)) {
  for (const auto& [name, descriptor] : operations) {
    const Operation* operation = operation_of(descriptor.ptr());
    if (!operation) throw py::error_already_set();
    operations_[py::cast<std::string>(name)] = operation;
  }
}

void Servant::keep_self() {
  if (self_ && !std::exchange(is_kept_, true)) Py_INCREF(self_);
}

CORBA::Boolean Servant::_is_a(const char* id) {
  return std::find(ids_.begin(), ids_.end(), id) != ids_.end() || std::strcmp(id, "IDL:omg.org/CORBA/Object:1.0") == 0;
}

CORBA::Boolean Servant::_dispatch(omniCallHandle& handle) {
  const auto found = operations_.find(handle.operation_name());
  if (found == operations_.end()) return false;
  std::unique_ptr<Upcall> call;
  {
    const Locked locked;
    if (!self_) throw CORBA::OBJECT_NOT_EXIST();
    call = std::make_unique<Upcall>(found->first.c_str(), *found->second, self_);
  }
  handle.upcall(this, *call);
  return true;
}

}  // namespace python

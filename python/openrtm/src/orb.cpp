#include "orb.h"

#include <omniORB4/CORBA.h>
#include <omniORB4/minorCode.h>
#include <pybind11/stl.h>
#include <rtm/Manager.h>

#include <optional>

#include "adapters.h"
#include "calls.h"
#include "coder.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/orb.h"
#include "references.h"

namespace py = pybind11;

namespace python {
namespace {

// Of a script without a manager; as long as the process.
corba::Orb* own_orb = nullptr;

CORBA::ORB_var current_orb() {
  int argc = 0;
  return CORBA::ORB_init(argc, nullptr, "omniORB4");
}

std::vector<std::string> orb_init(const std::vector<std::string>& words) {
  std::vector<std::string> rest, options;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with("-ORB")) {
      options.push_back(words[i]);
      if (i + 1 < words.size()) options.push_back(words[++i]);
    } else {
      rest.push_back(words[i]);
    }
  }
  if (!RTC::Manager::instance_if_any() && !own_orb) {
    corba::OrbSettings settings;
    settings.arguments = options;
    auto started = unlocked([&] { return corba::Orb::start(settings); });
    if (!started) throw std::runtime_error(started.error().message);
    own_orb = started->release();
  }
  return rest;
}

// A Python servant of this process is asked without a CORBA call, which would wait until its adapter is active.
bool is_a(const ObjRef& self, const std::string& id) {
  const py::object servant = local_servant(self);
  return servant.is_none() ? asked([&] { return bool(self.object->_is_a(id.c_str())); }) : py::cast<bool>(servant.attr("_is_a")(id));
}

bool non_existent(const ObjRef& self) {
  return local_servant(self).is_none() && asked([&] { return bool(self.object->_non_existent()); });
}

void add_references(py::module_& module) {
  py::class_<ObjRef>(module, "ObjRef")
      .def("invoke", &invoke)
      .def("is_a", &is_a)
      .def("non_existent", &non_existent)
      .def("is_equivalent",
           [](const ObjRef& self, const ObjRef& other) { return asked([&] { return bool(self.object->_is_equivalent(other.object)); }); })
      .def("hash", [](const ObjRef& self, CORBA::ULong most) { return asked([&] { return self.object->_hash(most); }); })
      .def("repository_id", [](const ObjRef& self) { return std::string(self.object->_PR_getobj()->_mostDerivedRepoId()); })
      .def("local_servant", &local_servant)
      // A reference of its own, whose calls take no longer than those of ports.
      .def("with_timeout",
           [](const ObjRef& self) {
             return asked([&] {
               const CORBA::ORB_var orb = current_orb();
               const CORBA::String_var text = orb->object_to_string(self.object);
               ObjRef own{orb->string_to_object(text)};
               corba::limit_calls(own.object, corba::port_call_timeout());
               return own;
             });
           })
      .def("set_timeout",
           [](const ObjRef& self, long milliseconds) { corba::limit_calls(self.object, std::chrono::milliseconds(milliseconds)); });
}

// The names and numbers of omniORB's minor codes.
py::dict minor_codes() {
  using namespace omni;
  py::dict all;
  for (const minorCodeLookup* table : {BAD_PARAM_LookupTable, BAD_INV_ORDER_LookupTable, COMM_FAILURE_LookupTable, INITIALIZE_LookupTable,
                                       INV_OBJREF_LookupTable, MARSHAL_LookupTable, NO_IMPLEMENT_LookupTable, OBJECT_NOT_EXIST_LookupTable,
                                       TIMEOUT_LookupTable, TRANSIENT_LookupTable, UNKNOWN_LookupTable})
    for (; table->name; ++table) all[table->name] = table->value;
  return all;
}

void add_orb_functions(py::module_& module) {
  module.def("minor_codes", &minor_codes);
  module.def("orb_init", &orb_init);
  module.def("orb_run", [] { unlocked([] { current_orb()->run(); }); });
  module.def("orb_shutdown", [] { unlocked([] { current_orb()->shutdown(false); }); });
  module.def("set_call_timeout", [](unsigned long milliseconds) { omniORB::setClientCallTimeout(milliseconds); });
  module.def("set_connect_timeout", [](unsigned long milliseconds) { omniORB::setClientConnectTimeout(milliseconds); });
  module.def("trace_level", [](std::optional<CORBA::ULong> level) {
    if (level) omniORB::traceLevel = *level;
    return omniORB::traceLevel;
  });
  module.def("string_to_object", [](const std::string& text) {
    const CORBA::Object_var object = asked([&] { return CORBA::Object_var(current_orb()->string_to_object(text.c_str())); });
    return py::reinterpret_steal<py::object>(reference_out(object, ""));
  });
  module.def("object_to_string", [](const ObjRef* object) {
    const CORBA::String_var text =
        asked([&] { return CORBA::String_var(current_orb()->object_to_string(object ? object->object.in() : CORBA::Object::_nil())); });
    return std::string(text.in());
  });
  module.def("resolve_initial_references", [](const std::string& name) {
    const CORBA::Object_var object = asked([&] { return CORBA::Object_var(current_orb()->resolve_initial_references(name.c_str())); });
    return py::reinterpret_steal<py::object>(reference_out(object, name == "NameService" ? "IDL:omg.org/CosNaming/NamingContext:1.0" : ""));
  });
  // Before anybody calls objects of a script without a manager.
  module.def("orb_activate", [] {
    if (own_orb) unlocked([] { own_orb->activate(); });
  });
}

[[noreturn]] void bad_parameter(const std::string& why) {
  static PyObject* const bad = of_module("omniORB.CORBA", "BAD_PARAM");
  static PyObject* const no = of_module("omniORB.CORBA", "COMPLETED_NO");
  const Ref made(PyObject_CallFunction(bad, "iOs", 0, no, why.c_str()));
  PyErr_SetObject(bad, made.get());
  throw py::error_already_set();
}

const Type& checked(const py::object& descriptor) {
  const Type* type = type_of(descriptor.ptr());
  if (!type) throw py::error_already_set();
  return *type;
}

py::bytes cdr_marshal(const py::object& descriptor, const py::object& value, const py::object& endian) {
  const Type& type = checked(descriptor);
  try {
    if (!endian.is_none()) {
      Octets octets;
      encode(type, value.ptr(), py::cast<bool>(endian), octets);
      return py::bytes(reinterpret_cast<const char*>(octets.data()), octets.size());
    }
    // An encapsulation: the octet of the byte order comes first, and members are aligned from it.
    cdrEncapsulationStream stream(CORBA::ULong(0), true);
    encode(type, value.ptr(), stream);
    return py::bytes(static_cast<const char*>(stream.bufPtr()), stream.bufSize());
  } catch (const BadValue& bad) {
    bad_parameter(bad.text());
  } catch (const PythonFailed&) {
  } catch (const CORBA::SystemException& problem) {
    set_python_exception(problem);
  }
  throw py::error_already_set();
}

py::object cdr_unmarshal(const py::object& descriptor, const std::string& octets, const py::object& endian) {
  const Type& type = checked(descriptor);
  try {
    if (!endian.is_none()) return py::reinterpret_steal<py::object>(decode(type, std::as_bytes(std::span(octets)), py::cast<bool>(endian)));
    cdrEncapsulationStream stream(reinterpret_cast<const CORBA::Octet*>(octets.data()), static_cast<CORBA::ULong>(octets.size()), true);
    return py::reinterpret_steal<py::object>(decode(type, stream));
  } catch (const PythonFailed&) {
    throw py::error_already_set();
  } catch (const BadOctets&) {
    set_python_exception(CORBA::MARSHAL(0, CORBA::COMPLETED_NO));
  } catch (const CORBA::SystemException& problem) {
    set_python_exception(problem);
  }
  throw py::error_already_set();
}

}  // namespace

void add_orb(py::module_& module) {
  // For what constructors and the like let through: after the end of the ORB, for instance.
  py::register_exception_translator([](std::exception_ptr problem) {
    try {
      std::rethrow_exception(problem);
    } catch (const CORBA::SystemException& system) {
      set_python_exception(system);
    } catch (const CORBA::UserException& user) {
      PyErr_SetString(PyExc_RuntimeError, user._name());
    }
  });
  add_references(module);
  add_orb_functions(module);
  module.def("cdr_marshal", &cdr_marshal);
  module.def("cdr_unmarshal", &cdr_unmarshal);
  module.def("set_text_coding", [](const std::string& name) {
    set_text_coding(name == "utf-8" ? TextCoding::utf8 : name == "latin-1" ? TextCoding::latin1 : TextCoding::automatic);
  });
}

}  // namespace python

#include "orb.h"

#include <pybind11/stl.h>

#include <cstring>

#include "calls.h"
#include "coder.h"
#include "component.h"
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

PortableServer::POA_ptr root_poa() {
  const CORBA::ORB_var orb = current_orb();
  const CORBA::Object_var object = orb->resolve_initial_references("RootPOA");
  return PortableServer::POA::_narrow(object);
}

py::bytes id_bytes(const PortableServer::ObjectId& id) { return py::bytes(reinterpret_cast<const char*>(id.get_buffer()), id.length()); }

PortableServer::ObjectId id_from(const std::string& octets) {
  PortableServer::ObjectId id;
  id.length(static_cast<CORBA::ULong>(octets.size()));
  if (!octets.empty()) std::memcpy(id.get_buffer(), octets.data(), octets.size());
  return id;
}

py::bytes activate(Servant& servant) {
  servant.keep_self();
  const PortableServer::ObjectId_var id = asked([&] {
    const PortableServer::POA_var poa = root_poa();
    try {
      return PortableServer::ObjectId_var(poa->activate_object(&servant));
    } catch (const PortableServer::POA::ServantAlreadyActive&) {
      return PortableServer::ObjectId_var(poa->servant_to_id(&servant));
    }
  });
  return id_bytes(id.in());
}

py::object reference_of(Servant& servant) {
  servant.keep_self();
  const CORBA::Object_var object = asked([&] {
    const PortableServer::POA_var poa = root_poa();
    return CORBA::Object_var(poa->servant_to_reference(&servant));
  });
  return py::reinterpret_steal<py::object>(reference_out(object, servant._mostDerivedRepoId()));
}

// The Python object behind a reference, when it is in this process.
py::object local_servant(const ObjRef& self) {
  Servant* own = nullptr;
  PortableServer::ServantBase* servant = nullptr;
  try {
    unlocked([&] {
      const PortableServer::POA_var poa = root_poa();
      servant = poa->reference_to_servant(self.object);
    });
  } catch (const CORBA::Exception&) {
    return py::none();
  }
  own = dynamic_cast<Servant*>(servant);
  py::object found = own && own->self() ? py::reinterpret_borrow<py::object>(own->self()) : py::object(py::none());
  unlocked([&] { servant->_remove_ref(); });
  return found;
}

void add_references(py::module_& module) {
  py::class_<ObjRef>(module, "ObjRef")
      .def("invoke", &invoke)
      .def("is_a", [](const ObjRef& self, const std::string& id) { return asked([&] { return bool(self.object->_is_a(id.c_str())); }); })
      .def("non_existent", [](const ObjRef& self) { return asked([&] { return bool(self.object->_non_existent()); }); })
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
  py::class_<Servant, std::shared_ptr<Servant>>(module, "Servant")
      .def(py::init([](const py::object& self, const py::dict& operations, std::vector<std::string> ids) {
        return owned(new Servant(self, operations, std::move(ids)));
      }))
      .def("this", &reference_of)
      .def("activate", &activate)
      .def("activate_with_id", [](Servant& servant, const std::string& id) {
        servant.keep_self();
        asked([&] {
          const PortableServer::POA_var poa = root_poa();
          poa->activate_object_with_id(id_from(id), &servant);
        });
      });
}

void add_orb_functions(py::module_& module) {
  module.def("orb_init", &orb_init);
  module.def("orb_run", [] { unlocked([] { current_orb()->run(); }); });
  module.def("orb_shutdown", [] { unlocked([] { current_orb()->shutdown(false); }); });
  module.def("set_call_timeout", [](unsigned long milliseconds) { omniORB::setClientCallTimeout(milliseconds); });
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
  module.def("poa_activate", [] {
    if (own_orb) return unlocked([] { own_orb->activate(); });
    asked([] {
      const PortableServer::POA_var poa = root_poa();
      const PortableServer::POAManager_var manager = poa->the_POAManager();
      manager->activate();
    });
  });
  module.def("poa_deactivate", [](const std::string& id) {
    asked([&] {
      const PortableServer::POA_var poa = root_poa();
      poa->deactivate_object(id_from(id));
    });
  });
  module.def("poa_id_to_reference", [](const std::string& id) {
    const CORBA::Object_var object = asked([&] {
      const PortableServer::POA_var poa = root_poa();
      return CORBA::Object_var(poa->id_to_reference(id_from(id)));
    });
    return py::reinterpret_steal<py::object>(reference_out(object, ""));
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

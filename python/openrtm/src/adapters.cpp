#include "adapters.h"

#include <pybind11/stl.h>

#include <cstring>
#include <utility>
#include <vector>

#include "calls.h"
#include "component.h"

namespace py = pybind11;

namespace python {
namespace {

namespace ps = PortableServer;

struct Adapter {
  ps::POA_var poa;
};

// All that Python has made, the root first; never destroyed. With the interpreter's lock.
std::vector<ps::POA_var>& all_adapters() {
  static auto& all = *new std::vector<ps::POA_var>;
  return all;
}

Adapter root() {
  auto& all = all_adapters();
  int argc = 0;
  const ps::POA_var poa = asked([&] {
    const CORBA::ORB_var orb = CORBA::ORB_init(argc, nullptr, "omniORB4");
    const CORBA::Object_var object = orb->resolve_initial_references("RootPOA");
    return ps::POA_var(ps::POA::_narrow(object));
  });
  if (all.empty()) all.push_back(poa);
  all.front() = poa;  // another one after the manager has ended and has begun again
  return {poa};
}

// Runs a call of the POA without the lock; its exceptions become those of Python.
template <class Call>
auto adapted(Call call) {
  try {
    return unlocked(call);
  } catch (const CORBA::SystemException& problem) {
    set_python_exception(problem);
  } catch (const CORBA::UserException& problem) {
    static PyObject* const exceptions = of_module("omniORB.PortableServer", "POA");
    const Ref cls(exceptions ? PyObject_GetAttrString(exceptions, problem._name()) : nullptr);
    if (!cls) PyErr_Clear();
    PyErr_SetNone(cls ? cls.get() : PyExc_RuntimeError);
  }
  throw py::error_already_set();
}

py::bytes id_bytes(const ps::ObjectId& id) { return py::bytes(reinterpret_cast<const char*>(id.get_buffer()), id.length()); }

ps::ObjectId id_from(const std::string& octets) {
  ps::ObjectId id;
  id.length(static_cast<CORBA::ULong>(octets.size()));
  if (!octets.empty()) std::memcpy(id.get_buffer(), octets.data(), octets.size());
  return id;
}

py::object stub_of(const CORBA::Object_var& object, const char* id = "") {
  return py::reinterpret_steal<py::object>(reference_out(object, id));
}

// --- policies

template <class Value>
Value valued(int number) {
  return static_cast<Value>(number);
}

CORBA::Policy_ptr policy(ps::POA_ptr poa, int kind, int value) {
  switch (static_cast<CORBA::ULong>(kind)) {
    case ps::THREAD_POLICY_ID:
      return poa->create_thread_policy(valued<ps::ThreadPolicyValue>(value));
    case ps::LIFESPAN_POLICY_ID:
      return poa->create_lifespan_policy(valued<ps::LifespanPolicyValue>(value));
    case ps::ID_UNIQUENESS_POLICY_ID:
      return poa->create_id_uniqueness_policy(valued<ps::IdUniquenessPolicyValue>(value));
    case ps::ID_ASSIGNMENT_POLICY_ID:
      return poa->create_id_assignment_policy(valued<ps::IdAssignmentPolicyValue>(value));
    case ps::IMPLICIT_ACTIVATION_POLICY_ID:
      return poa->create_implicit_activation_policy(valued<ps::ImplicitActivationPolicyValue>(value));
    case ps::SERVANT_RETENTION_POLICY_ID:
      return poa->create_servant_retention_policy(valued<ps::ServantRetentionPolicyValue>(value));
    case ps::REQUEST_PROCESSING_POLICY_ID:
      return poa->create_request_processing_policy(valued<ps::RequestProcessingPolicyValue>(value));
    default:
      throw ps::POA::InvalidPolicy();
  }
}

// `manager`: the adapter whose POA manager the new one shares; nullptr: one of its own.
Adapter create(const Adapter& self, const std::string& name, const Adapter* manager, const std::vector<std::pair<int, int>>& policies) {
  const ps::POA_var made = adapted([&] {
    CORBA::PolicyList list;
    for (const auto& [kind, value] : policies) {
      const CORBA::ULong n = list.length();
      list.length(n + 1);
      list[n] = policy(self.poa, kind, value);
    }
    const ps::POAManager_var shared = manager ? manager->poa->the_POAManager() : ps::POAManager::_nil();
    return ps::POA_var(self.poa->create_POA(name.c_str(), shared, list));
  });
  root();
  all_adapters().push_back(made);
  return {made};
}

// --- servants

py::bytes activate(const Adapter& self, Servant& servant) {
  servant.keep_self();
  const ps::ObjectId_var id = adapted([&] {
    try {
      return ps::ObjectId_var(self.poa->activate_object(&servant));
    } catch (const ps::POA::ServantAlreadyActive&) {  // by _this()
      return ps::ObjectId_var(self.poa->servant_to_id(&servant));
    }
  });
  servant.set_adapter(self.poa);
  return id_bytes(id.in());
}

void activate_with_id(const Adapter& self, const std::string& id, Servant& servant) {
  servant.keep_self();
  adapted([&] { self.poa->activate_object_with_id(id_from(id), &servant); });
  servant.set_adapter(self.poa);
}

py::bytes servant_to_id(const Adapter& self, Servant& servant) {
  servant.keep_self();
  const ps::ObjectId_var id = adapted([&] { return ps::ObjectId_var(self.poa->servant_to_id(&servant)); });
  servant.set_adapter(self.poa);
  return id_bytes(id.in());
}

// In the adapter where it is active; else it becomes active in this one.
py::object reference_of(const Adapter& self, Servant& servant) {
  servant.keep_self();
  const ps::POA_var poa = ps::POA::_duplicate(CORBA::is_nil(servant.adapter()) ? self.poa.in() : servant.adapter());
  const CORBA::Object_var object = adapted([&] { return CORBA::Object_var(poa->servant_to_reference(&servant)); });
  servant.set_adapter(poa);
  return stub_of(object, servant._mostDerivedRepoId());
}

void set_servant(const Adapter& self, Servant& servant) {
  servant.keep_self();
  adapted([&] { self.poa->set_servant(&servant); });
}

void change_manager(const Adapter& self, const std::string& change, bool etherealize, bool wait) {
  adapted([&] {
    const ps::POAManager_var manager = self.poa->the_POAManager();
    if (change == "activate") return manager->activate();
    if (change == "hold") return manager->hold_requests(wait);
    if (change == "discard") return manager->discard_requests(wait);
    manager->deactivate(etherealize, wait);
  });
}

int manager_state(const Adapter& self) {
  return adapted([&] {
    const ps::POAManager_var manager = self.poa->the_POAManager();
    return static_cast<int>(manager->get_state());
  });
}

Adapter find(const Adapter& self, const std::string& name) {
  return {adapted([&] { return ps::POA_var(self.poa->find_POA(name.c_str(), false)); })};
}

}  // namespace

py::object local_servant(const ObjRef& reference) {
  try {
    root();
  } catch (py::error_already_set&) {  // the ORB has ended
    return py::none();
  }
  const auto adapters = all_adapters();
  ps::ServantBase* servant = nullptr;
  unlocked([&] {
    for (const auto& poa : adapters) {
      try {
        servant = poa->reference_to_servant(reference.object);
        return;
      } catch (const CORBA::Exception&) {  // of another adapter, or of one that has been destroyed
      }
    }
  });
  if (!servant) return py::none();
  auto* const own = dynamic_cast<Servant*>(servant);
  py::object found = own && own->self() ? py::reinterpret_borrow<py::object>(own->self()) : py::object(py::none());
  unlocked([&] { servant->_remove_ref(); });
  return found;
}

void add_adapters(py::module_& module) {
  py::class_<Servant, std::shared_ptr<Servant>>(module, "Servant")
      .def(py::init([](const py::object& self, const py::dict& operations, std::vector<std::string> ids) {
        return owned(new Servant(self, operations, std::move(ids)));
      }));
  py::class_<Adapter>(module, "Adapter")
      .def("create", &create)
      .def("find", &find)
      .def("name", [](const Adapter& self) { return std::string(CORBA::String_var(adapted([&] { return self.poa->the_name(); })).in()); })
      .def("destroy", [](const Adapter& self, bool etherealize, bool wait) { adapted([&] { self.poa->destroy(etherealize, wait); }); })
      .def("activate", &activate)
      .def("activate_with_id", &activate_with_id)
      .def("deactivate", [](const Adapter& self, const std::string& id) { adapted([&] { self.poa->deactivate_object(id_from(id)); }); })
      .def("servant_to_id", &servant_to_id)
      .def("reference_of", &reference_of)
      .def("reference_to_id",
           [](const Adapter& self, const ObjRef& reference) {
             return id_bytes(adapted([&] { return ps::ObjectId_var(self.poa->reference_to_id(reference.object)); }).in());
           })
      .def("id_to_reference",
           [](const Adapter& self, const std::string& id) {
             return stub_of(adapted([&] { return CORBA::Object_var(self.poa->id_to_reference(id_from(id))); }));
           })
      .def("create_reference_with_id",
           [](const Adapter& self, const std::string& id, const std::string& type) {
             return stub_of(adapted([&] { return CORBA::Object_var(self.poa->create_reference_with_id(id_from(id), type.c_str())); }),
                            type.c_str());
           })
      .def("set_servant", &set_servant)
      .def("change_manager", &change_manager)
      .def("manager_state", &manager_state);
  module.def("root_adapter", &root);
}

}  // namespace python

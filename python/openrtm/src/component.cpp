#include "component.h"

#include <pybind11/stl.h>
#include <rtm/CorbaPort.h>

#include "complaint.h"
#include "component/managed.h"
#include "composites.h"
#include "convert.h"
#include "ports.h"
#include "properties.h"
#include "references.h"
#include "sdo.h"

namespace py = pybind11;

namespace python {
namespace {

PyObject* interned(const char* text) { return PyUnicode_InternFromString(text); }

// RTC.ReturnCode_t, in the order of its items.
PyObject* return_codes() {
  static PyObject* const items = [] {
    const Ref all(of_module("RTC", "ReturnCode_t"));
    return all ? PyObject_GetAttrString(all.get(), "_items") : nullptr;
  }();
  return items;
}

std::string shown(PyObject* object) {
  const Ref text(PyObject_Repr(object));
  const char* utf8 = text ? PyUnicode_AsUTF8(text.get()) : nullptr;
  if (!utf8) PyErr_Clear();
  return utf8 ? utf8 : Py_TYPE(object)->tp_name;
}

}  // namespace

RTC::ReturnCode_t code_of_result(PyObject* result) {
  PyObject* const items = return_codes();
  if (items && PyTuple_Check(items)) {
    for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(items); ++i) {
      PyObject* const item = PyTuple_GET_ITEM(items, i);
      if (item == result) return static_cast<RTC::ReturnCode_t>(i);
    }
    // Of other stubs of the same IDL.
    for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(items); ++i) {
      if (PyObject_RichCompareBool(PyTuple_GET_ITEM(items, i), result, Py_EQ) == 1) return static_cast<RTC::ReturnCode_t>(i);
    }
  }
  PyErr_Clear();
  throw Raised("it returned " + shown(result) + "; expected RTC.RTC_OK or another RTC.ReturnCode_t");
}

py::object code_item(RTC::ReturnCode_t code) {
  PyObject* const items = return_codes();
  return py::reinterpret_borrow<py::object>(PyTuple_GetItem(items, static_cast<Py_ssize_t>(code)));
}

void Component::bind_self(PyObject* self) {
  self_ = self;
  static PyObject* const base = of_module("OpenRTM_aist.component", "DataFlowComponentBase");
  const Ref own(PyObject_GetAttrString(reinterpret_cast<PyObject*>(Py_TYPE(self)), "onStateUpdate"));
  const Ref inherited(base ? PyObject_GetAttrString(base, "onStateUpdate") : nullptr);
  updates_state_ = !own || !inherited || own.get() != inherited.get();
  PyErr_Clear();
}

void Component::leave() { RTC::discard(*this); }

void Component::keep_self() {
  if (self_ && !std::exchange(is_kept_, true)) Py_INCREF(self_);
}

void Component::let_self_go() {
  if (!std::exchange(is_kept_, false) || !self_) return;
  const Ref self(self_);
  const Ref result(PyObject_CallMethod(self.get(), "_rtm_let_go", nullptr));
  if (!result) PyErr_Clear();
}

RTC::ReturnCode_t Component::callback(PyObject* name, const RTC::UniqueId* id) {
  const Locked locked;
  if (!self_) return RTC::RTC_ERROR;
  const Ref self = Ref::borrowed(self_);
  const Ref number(id ? PyLong_FromLong(*id) : nullptr);
  PyObject* arguments[] = {self.get(), number.get()};
  const Ref result(PyObject_VectorcallMethod(name, arguments, id ? 2 : 1, nullptr));
  if (!result) throw Raised(take_error());
  return code_of_result(result.get());
}

namespace {

// The names of the callbacks; made when the module is loaded, kept for ever.
struct Names {
  PyObject* onInitialize = interned("onInitialize");
  PyObject* onFinalize = interned("onFinalize");
  PyObject* onStartup = interned("onStartup");
  PyObject* onShutdown = interned("onShutdown");
  PyObject* onActivated = interned("onActivated");
  PyObject* onDeactivated = interned("onDeactivated");
  PyObject* onExecute = interned("onExecute");
  PyObject* onAborting = interned("onAborting");
  PyObject* onError = interned("onError");
  PyObject* onReset = interned("onReset");
  PyObject* onStateUpdate = interned("onStateUpdate");
  PyObject* onRateChanged = interned("onRateChanged");
};
const Names* names = nullptr;

}  // namespace

RTC::ReturnCode_t Component::onInitialize() { return callback(names->onInitialize, nullptr); }
RTC::ReturnCode_t Component::onFinalize() { return callback(names->onFinalize, nullptr); }
RTC::ReturnCode_t Component::onStartup(RTC::UniqueId id) { return callback(names->onStartup, &id); }
RTC::ReturnCode_t Component::onShutdown(RTC::UniqueId id) { return callback(names->onShutdown, &id); }
RTC::ReturnCode_t Component::onActivated(RTC::UniqueId id) { return callback(names->onActivated, &id); }
RTC::ReturnCode_t Component::onDeactivated(RTC::UniqueId id) { return callback(names->onDeactivated, &id); }
RTC::ReturnCode_t Component::onExecute(RTC::UniqueId id) { return callback(names->onExecute, &id); }
RTC::ReturnCode_t Component::onAborting(RTC::UniqueId id) { return callback(names->onAborting, &id); }
RTC::ReturnCode_t Component::onError(RTC::UniqueId id) { return callback(names->onError, &id); }
RTC::ReturnCode_t Component::onReset(RTC::UniqueId id) { return callback(names->onReset, &id); }
RTC::ReturnCode_t Component::onStateUpdate(RTC::UniqueId id) { return updates_state_ ? callback(names->onStateUpdate, &id) : RTC::RTC_OK; }
RTC::ReturnCode_t Component::onRateChanged(RTC::UniqueId id) { return callback(names->onRateChanged, &id); }

bool Component::bind_parameter(const std::string& name, const std::string& default_value, const py::object& function) {
  bound_.push_back(std::make_unique<Function>(function));
  Function& bound = *bound_.back();
  const auto assign = [this, name](Function& take, const char* text) {
    std::string problem;
    {
      const Locked locked;
      try {
        return py::cast<bool>(call(take, py::make_tuple(std::string(text))));
      } catch (const Raised& raised) {
        problem = raised.what();
      } catch (const py::cast_error&) {
        return false;
      }
    }
    RTC_ERROR(("parameter %s: the conversion raised: %s", name.c_str(), problem.c_str()));
    return false;
  };
  const Released released;
  return bindParameter(name.c_str(), bound, default_value.c_str(), assign);
}

// --- listeners of components

namespace {

// `kind`: of listener.
template <class Call>
void heard(const Component& owner, const char* kind, const Function& function, Complaint& complaint, Call arguments) {
  const Locked locked;
  std::string problem;
  try {
    call(function, arguments());
    return;
  } catch (const Raised& raised) {
    problem = raised.what();
  } catch (py::error_already_set& error) {
    error.restore();
    problem = take_error();
  }
  const auto line = complaint.next(problem);
  if (!line) return;
  const Released released;
  RTC::Logger(owner.getInstanceName()).write(RTC::Logger::RTL_ERROR, std::string("a ") + kind + " raised: " + *line);
}

template <class Base, class... Args>
class Heard : public Base {
 public:
  Heard(const Component& owner, const char* kind, const py::object& function) : owner_(owner), kind_(kind), function_(function) {}
  void operator()(Args... args) override {
    heard(owner_, kind_, function_, complaint_, [&] { return py::make_tuple(to_argument(args)...); });
  }

 private:
  static py::object to_argument(const char* text) { return py::str(text); }
  static py::object to_argument(RTC::UniqueId id) { return py::int_(id); }
  static py::object to_argument(RTC::ReturnCode_t code) { return code_item(code); }
  static py::object to_argument(const RTC::PortProfile& profile) { return to_python(profile, "IDL:omg.org/RTC/PortProfile:1.0"); }
  static py::object to_argument(RTC::ConnectorProfile& profile) { return to_python(profile, "IDL:omg.org/RTC/ConnectorProfile:1.0"); }
  static py::object to_argument(const coil::Properties& set) { return py::cast(Properties::copy_of(set)); }
  const Component& owner_;
  const char* const kind_;
  const Function function_;
  Complaint complaint_;
};

template <class Type>
Type as(int type) {
  return static_cast<Type>(type);
}

}  // namespace

void Component::add_listener(int group, int type, const py::object& function) {
  using namespace RTC;
  switch (group) {
    case 0:
      return addPreComponentActionListener(as<PreComponentActionListenerType>(type),
                                           new Heard<PreComponentActionListener, UniqueId>(*this, "PreComponentActionListener", function));
    case 1:
      return addPostComponentActionListener(
          as<PostComponentActionListenerType>(type),
          new Heard<PostComponentActionListener, UniqueId, ReturnCode_t>(*this, "PostComponentActionListener", function));
    case 2:
      return addPortActionListener(as<PortActionListenerType>(type),
                                   new Heard<PortActionListener, const PortProfile&>(*this, "PortActionListener", function));
    case 3:
      return addExecutionContextActionListener(
          as<ExecutionContextActionListenerType>(type),
          new Heard<ExecutionContextActionListener, UniqueId>(*this, "ExecutionContextActionListener", function));
    case 4:
      return addPortConnectListener(as<PortConnectListenerType>(type),
                                    new Heard<PortConnectListener, const char*, ConnectorProfile&>(*this, "PortConnectListener", function));
    case 5:
      return addPortConnectRetListener(
          as<PortConnectRetListenerType>(type),
          new Heard<PortConnectRetListener, const char*, ConnectorProfile&, ReturnCode_t>(*this, "PortConnectRetListener", function));
    case 6:
      return addConfigurationParamListener(
          as<ConfigurationParamListenerType>(type),
          new Heard<ConfigurationParamListener, const char*, const char*>(*this, "ConfigurationParamListener", function));
    case 7:
      return addConfigurationSetListener(
          as<ConfigurationSetListenerType>(type),
          new Heard<ConfigurationSetListener, const coil::Properties&>(*this, "ConfigurationSetListener", function));
    case 8:
      return addConfigurationSetNameListener(
          as<ConfigurationSetNameListenerType>(type),
          new Heard<ConfigurationSetNameListener, const char*>(*this, "ConfigurationSetNameListener", function));
    case 9:
      return addPreFsmActionListener(as<PreFsmActionListenerType>(type),
                                     new Heard<PreFsmActionListener, const char*>(*this, "PreFsmActionListener", function));
    case 10:
      return addPostFsmActionListener(as<PostFsmActionListenerType>(type), new Heard<PostFsmActionListener, const char*, ReturnCode_t>(
                                                                               *this, "PostFsmActionListener", function));
    default:
      throw py::index_error("no such kind of listener");
  }
}

// --- for Python

py::object python_component(RTC::RTObject_impl* component) {
  if (!component) return py::none();
  if (auto* const own = dynamic_cast<Component*>(component)) {
    if (own->self()) return py::reinterpret_borrow<py::object>(own->self());
    return py::none();
  }
  CORBA::Object_var object;
  unlocked([&] { object = component->getObjRef(); });
  return py::reinterpret_steal<py::object>(reference_out(object, "IDL:omg.org/RTC/RTObject:1.0"));
}

namespace {

using Holder = std::shared_ptr<Component>;

std::vector<py::object> sets_of(Component& self) {
  std::vector<py::object> list;
  for (const auto& set : self.m_configsets.getConfigurationSets()) list.push_back(py::cast(Properties::copy_of(set)));
  return list;
}

void add_configuration(py::class_<Component, Holder>& cls) {
  cls.def("_rtm_config_update",
          [](Component& self, const std::string& set, const std::string& parameter) {
            const Released released;
            if (set.empty())
              self.m_configsets.update();
            else if (parameter.empty())
              self.m_configsets.update(set.c_str());
            else
              self.m_configsets.update(set.c_str(), parameter.c_str());
          })
      .def("_rtm_config_has_parameter", [](Component& self, const std::string& name) { return self.m_configsets.isExist(name.c_str()); })
      .def("_rtm_config_unbind", [](Component& self, const std::string& name) { return self.m_configsets.unbindParameter(name.c_str()); })
      .def("_rtm_config_is_changed", [](Component& self) { return self.m_configsets.isChanged(); })
      .def("_rtm_config_active_id", [](Component& self) { return std::string(self.m_configsets.getActiveId()); })
      .def("_rtm_config_have", [](Component& self, const std::string& id) { return self.m_configsets.haveConfig(id.c_str()); })
      .def("_rtm_config_is_active", [](Component& self) { return self.m_configsets.isActive(); })
      .def("_rtm_config_sets", &sets_of)
      .def("_rtm_config_set",
           [](Component& self, const std::string& id) { return Properties::copy_of(self.m_configsets.getConfigurationSet(id.c_str())); })
      .def("_rtm_config_set_values",
           [](Component& self, const Properties& set) {
             return unlocked([&] { return self.m_configsets.setConfigurationSetValues(*set.node); });
           })
      .def(
          "_rtm_config_add",
          [](Component& self, const Properties& set) { return unlocked([&] { return self.m_configsets.addConfigurationSet(*set.node); }); })
      .def("_rtm_config_remove",
           [](Component& self, const std::string& id) {
             return unlocked([&] { return self.m_configsets.removeConfigurationSet(id.c_str()); });
           })
      .def("_rtm_config_activate", [](Component& self, const std::string& id) {
        return unlocked([&] { return self.m_configsets.activateConfigurationSet(id.c_str()); });
      });
}

void add_names(py::class_<Component, Holder>& cls) {
  cls.def("getInstanceName", [](Component& self) { return std::string(self.getInstanceName()); })
      .def("setInstanceName", [](Component& self, const std::string& name) { unlocked([&] { self.setInstanceName(name.c_str()); }); })
      .def("getTypeName", [](Component& self) { return std::string(self.getTypeName()); })
      .def("getDescription", [](Component& self) { return std::string(self.getDescription()); })
      .def("getVersion", [](Component& self) { return std::string(self.getVersion()); })
      .def("getVendor", [](Component& self) { return std::string(self.getVendor()); })
      .def("getCategory", [](Component& self) { return std::string(self.getCategory()); })
      .def("getNamingNames", [](Component& self) { return self.getNamingNames(); })
      .def(
          "_rtm_properties_of",
          [](Component& self) {
            return Properties{nullptr, &self.m_properties};
          },
          py::keep_alive<0, 1>())
      .def("setProperties", [](Component& self, const Properties& other) { unlocked([&] { self.setProperties(*other.node); }); })
      .def("_rtm_reference", [](Component& self) {
        CORBA::Object_var object;
        unlocked([&] { object = self.getObjRef(); });
        return py::reinterpret_steal<py::object>(reference_out(object, "IDL:openrtm.aist.go.jp/OpenRTM/DataFlowComponent:1.0"));
      });
}

void add_ports_of_components(py::class_<Component, Holder>& cls) {
  cls.def("_rtm_add_in_port", [](Component& self, const std::string& name,
                                 RTC::InPortBase& port) { return unlocked([&] { return self.addInPort(name.c_str(), port); }); })
      .def("_rtm_add_out_port", [](Component& self, const std::string& name,
                                   OutPort& port) { return unlocked([&] { return self.addOutPort(name.c_str(), port); }); })
      .def("_rtm_add_port", [](Component& self, RTC::PortBase& port) { return unlocked([&] { return self.addPort(port); }); })
      .def("_rtm_remove_port", [](Component& self, RTC::PortBase& port) { return unlocked([&] { return self.removePort(port); }); })
      .def("readAll", [](Component& self) { return unlocked([&] { return self.readAll(); }); })
      .def("writeAll", [](Component& self) { return unlocked([&] { return self.writeAll(); }); })
      .def(
          "setReadAll", [](Component& self, bool read, bool completion) { self.setReadAll(read, completion); }, py::arg("read") = true,
          py::arg("completion") = false)
      .def(
          "setWriteAll", [](Component& self, bool write, bool completion) { self.setWriteAll(write, completion); }, py::arg("write") = true,
          py::arg("completion") = false);
}

// What state machines of Python tell their listeners: before (after) an entry, an exit, ...
void tell_fsm(Component& self, bool is_after, int action, const std::string& state, const py::object& code) {
  const RTC::ReturnCode_t result = is_after ? code_of_result(code.ptr()) : RTC::RTC_OK;
  const char* const name = state.c_str();
  unlocked([&] {
    switch (action) {
      case 0:
        return is_after ? self.postOnFsmInit(name, result) : self.preOnFsmInit(name);
      case 1:
        return is_after ? self.postOnFsmEntry(name, result) : self.preOnFsmEntry(name);
      case 2:
        return is_after ? self.postOnFsmDo(name, result) : self.preOnFsmDo(name);
      case 3:
        return is_after ? self.postOnFsmExit(name, result) : self.preOnFsmExit(name);
      default:
        return is_after ? self.postOnFsmStateChange(name, result) : self.preOnFsmStateChange(name);
    }
  });
}

void add_contexts_of_components(py::class_<Component, Holder>& cls) {
  const auto coded = [](auto function) {
    return [function](Component& self, long id) {
      return code_item(unlocked([&] { return (self.*function)(static_cast<RTC::UniqueId>(id)); }));
    };
  };
  cls.def("activate", coded(&Component::activate))
      .def("deactivate", coded(&Component::deactivate))
      .def("reset", coded(&Component::reset))
      .def("isOwnExecutionContext", [](Component& self, long id) { return self.isOwnExecutionContext(static_cast<RTC::UniqueId>(id)); })
      .def("getExecutionRate",
           [](Component& self, long id) { return unlocked([&] { return self.getExecutionRate(static_cast<RTC::UniqueId>(id)); }); })
      .def("setExecutionRate",
           [](Component& self, long id, double rate) {
             return code_item(unlocked([&] { return self.setExecutionRate(static_cast<RTC::UniqueId>(id), rate); }));
           })
      .def("getExecutionContext",
           [](Component& self, long id) {
             CORBA::Object_var object;
             unlocked([&] { object = self.getExecutionContext(static_cast<RTC::UniqueId>(id)); });
             return py::reinterpret_steal<py::object>(reference_out(object, "IDL:omg.org/RTC/ExecutionContext:1.0"));
           })
      .def("exit", [](Component& self) { return code_item(unlocked([&] { return self.exit(); })); })
      .def("finalize", [](Component& self) { return code_item(unlocked([&] { return self.finalize(); })); })
      .def("initialize", [](Component& self) { return code_item(unlocked([&] { return self.initialize(); })); });
}

}  // namespace

void add_components(py::module_& module) {
  names = new Names;
  py::class_<Component, Holder> cls(module, "Component");
  cls.def(py::init([] {
       RTC::Manager* manager = RTC::Manager::instance_if_any();
       if (!manager) throw std::runtime_error("there is no manager yet: call OpenRTM_aist.Manager.init first");
       return owned(unlocked([&] { return new Component(manager); }));
     }))
      .def("_rtm_bind_self", [](Component& self, py::object object) { self.bind_self(object.ptr()); })
      .def("_rtm_bind_parameter", &Component::bind_parameter)
      .def("_rtm_add_listener", &Component::add_listener)
      .def("_rtm_tell_fsm", &tell_fsm)
      .def("_rtm_notify_fsm", [](Component& self, bool is_structure, const std::string& hint) {
        using Status = RTC::RTObject_impl::Status;
        unlocked([&] { self.notifyObservers(is_structure ? Status::fsm_structure : Status::fsm_profile, hint); });
      });
  add_names(cls);
  add_ports_of_components(cls);
  add_contexts_of_components(cls);
  add_configuration(cls);
  add_sdo_of_components(cls);
  add_organization_of_components(cls);
}

}  // namespace python

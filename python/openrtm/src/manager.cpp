#include "manager.h"

#include <pybind11/stl.h>
#include <rtm/DataType.h>
#include <rtm/Manager.h>
#include <rtm/ManagerServant.h>
#include <rtm/NamingManager.h>
#include <rtm/Timestamp.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "complaint.h"
#include "component.h"
#include "component/managed.h"
#include "listeners.h"
#include "manager/scripts.h"
#include "properties.h"
#include "references.h"

namespace py = pybind11;

namespace python {
namespace {

RTC::Manager& the_manager() {
  RTC::Manager* manager = RTC::Manager::instance_if_any();
  if (!manager) throw std::runtime_error("there is no manager yet: call OpenRTM_aist.Manager.init first");
  return *manager;
}

void log_error(const char* name, const std::string& text) { RTC::Logger(name).write(RTC::Logger::RTL_ERROR, text); }

// --- factories

// Makes components by a function of Python, and keeps their Python objects alive until the runtime has let them go.
class Factory final : public RTC::FactoryBase {
 public:
  Factory(const coil::Properties& profile, const py::object& create) : FactoryBase(profile), create_(create) {}

  RTC::RTObject_impl* create(RTC::Manager*) override {
    std::string problem;
    Component* made = nullptr;
    {
      const Locked locked;
      try {
        const py::object object = call(create_, py::tuple());
        made = py::cast<Component*>(object);
        if (made) {
          made->keep_self();
          made->_add_ref();
        }
      } catch (const Raised& raised) {
        problem = raised.what();
      } catch (const py::cast_error&) {
        problem = "its class is not derived from OpenRTM_aist.DataFlowComponentBase, or its __init__ does not call that of the base";
      }
    }
    if (!made) log_error("manager", "creating a " + profile_.getProperty("implementation_id") + " failed: " + problem);
    return made;
  }

  void destroy(RTC::RTObject_impl* component) override {
    auto* const own = static_cast<Component*>(component);
    {
      const Locked locked;
      own->let_self_go();
    }
    own->_remove_ref();
  }

 private:
  const Function create_;
};

// --- life

// What has been given to the manager lives as long as the process.
PyObject* init_function = nullptr;

// Nil with manager.corba_servant NO. Stored when the manager starts, because the servant is deleted when the manager has ended.
RTM::Manager_ptr manager_reference = RTM::Manager::_nil();

class Host : public RTC::Manager {
 public:
  static RTM::ManagerServant* servant(const RTC::Manager& manager) { return manager.*&Host::m_mgrservant; }
};

void init_modules(RTC::Manager*) {
  std::string problem;
  {
    const Locked locked;
    const Ref result(PyObject_CallNoArgs(init_function));
    if (result) return;
    problem = take_error();
  }
  log_error("manager", "the module init function raised: " + problem);
}

void init(const std::vector<std::string>& words, bool is_host, const std::vector<std::string>& modules, const py::object& loader) {
  auto* const kept = new std::vector<std::string>(words);
  auto* const arguments = new std::vector<char*>;
  for (auto& word : *kept) arguments->push_back(word.data());
  arguments->push_back(nullptr);
  const RTC::ManagerOptions options{.strict_arguments = is_host, .bind_manager = is_host, .modules = modules};
  RTC::Manager* const manager = unlocked([&] { return RTC::Manager::init(static_cast<int>(words.size()), arguments->data(), options); });
  if (const auto* servant = Host::servant(*manager)) manager_reference = RTM::Manager::_duplicate(servant->getObjRef());
  const Function load(loader);
  RTC::set_script_loader(*manager, [load](const std::string& file, const std::string& function) -> std::string {
    const Locked locked;
    try {
      return py::cast<std::string>(call(load, py::make_tuple(file, function)));
    } catch (const Raised& raised) {
      return raised.what();
    } catch (const py::cast_error& problem) {
      return problem.what();
    }
  });
}

// Waits for the end, and lets Python's own signal handlers run meanwhile.
void run(bool no_block) {
  RTC::Manager& manager = the_manager();
  // The life thread does the rest. The author's main loop does not hear of a signal, so the runtime ends the process 2 s after it.
  if (no_block) return;
  std::atomic<bool> is_over{false};
  std::thread runner([&] {
    manager.runManager();
    is_over.store(true, std::memory_order_release);  // pairs with the acquire below
    is_over.notify_all();
  });
  // A signal that Python handles interrupts nothing here: it is looked for ten times a second.
  constexpr std::chrono::milliseconds look{100};
  bool has_raised = false;
  while (!is_over.load(std::memory_order_acquire)) {
    unlocked([&] {
      const auto end = std::chrono::steady_clock::now() + look;
      while (!is_over.load(std::memory_order_acquire) && std::chrono::steady_clock::now() < end)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    });
    if (!has_raised && PyErr_CheckSignals() != 0) {
      has_raised = true;
      manager.terminate();
    }
  }
  unlocked([&] { runner.join(); });
  if (has_raised) throw py::error_already_set();
}

py::object create_component(const std::string& arguments) {
  RTC::RTObject_impl* const component = unlocked([&] { return the_manager().createComponent(arguments); });
  return python_component(component);
}

py::list components() {
  py::list list;
  for (auto* component : unlocked([] { return the_manager().getComponents(); })) list.append(python_component(component));
  return list;
}

py::list copies(const std::vector<coil::Properties>& all) {
  py::list list;
  for (const auto& one : all) list.append(Properties::copy_of(one));
  return list;
}

bool register_factory(const Properties& profile, const py::object& create) {
  auto factory = std::make_shared<Factory>(*profile.node, create);
  return unlocked([&] { return RTC::register_factory(the_manager(), std::move(factory)); });
}

std::function<void()> task_of(const py::object& function) {
  return [task = Function(function), complaint = std::make_shared<Complaint>()] {
    std::optional<std::string> problem;
    {
      const Locked locked;
      try {
        call(task, py::tuple());
        return;
      } catch (const Raised& raised) {
        problem = complaint->next(raised.what());
      }
    }
    if (problem) log_error("manager", "a task raised: " + *problem);
  };
}

void add_life(py::module_& module) {
  module.def("manager_init", &init);
  module.def("manager_exists", [] { return RTC::Manager::instance_if_any() != nullptr; });
  module.def("manager_activate", [] { return unlocked([] { return the_manager().activateManager(); }); });
  module.def("manager_run", &run);
  module.def("manager_shutdown", [] { unlocked([] { the_manager().shutdown(); }); });
  module.def("manager_terminate", [] { unlocked([] { the_manager().terminate(); }); });
  module.def("close_doors", &close_doors);
  module.def("manager_join", [] { unlocked([] { the_manager().join(); }); });
  module.def("manager_is_running", [] { return the_manager().isRunning(); });
  module.def("manager_set_init_function", [](const py::object& function) {
    init_function = py::object(function).release().ptr();
    the_manager().setModuleInitProc(&init_modules);
  });
  module.def("manager_reference", [] {
    auto* const reference = the_manager().isRunning() ? manager_reference : RTM::Manager::_nil();
    return py::reinterpret_steal<py::object>(reference_out(reference, "IDL:RTM/Manager:1.0"));
  });
  module.def("manager_config", [] { return Properties{nullptr, &the_manager().getConfig()}; });
}

void add_modules_and_components(py::module_& module) {
  module.def("manager_load", [](const std::string& file, const std::string& function) {
    return static_cast<int>(unlocked([&] { return the_manager().load(file, function); }));
  });
  module.def("manager_unload",
             [](const std::string& file) { return static_cast<int>(unlocked([&] { return the_manager().unload(file.c_str()); })); });
  module.def("manager_loaded_modules", [] { return copies(unlocked([] { return the_manager().getLoadedModules(); })); });
  module.def("manager_loadable_modules", [] { return copies(unlocked([] { return the_manager().getLoadableModules(); })); });
  module.def("manager_factory_profiles", [] { return copies(unlocked([] { return the_manager().getFactoryProfiles(); })); });
  module.def("manager_register_factory", &register_factory);
  module.def("manager_create_component", &create_component);
  module.def("manager_components", &components);
  module.def("manager_component",
             [](const std::string& name) { return python_component(unlocked([&] { return the_manager().getComponent(name); })); });
  module.def("manager_delete_component", [](const std::string& name) {
    return static_cast<int>(unlocked([&] { return the_manager().deleteComponent(name.c_str()); }));
  });
  module.def("manager_connect", [](const std::string& text) { unlocked([&] { the_manager().connectPorts(text); }); });
  module.def("manager_add_task", [](const py::object& function, double period, double delay) {
    const auto nanoseconds = [](double seconds) { return std::chrono::nanoseconds(static_cast<std::int64_t>(seconds * 1e9)); };
    auto task = task_of(function);
    return unlocked([&] { return the_manager().addTask(std::move(task), nanoseconds(period), nanoseconds(delay)); });
  });
  module.def("manager_remove_task", [](std::uint64_t id) { return unlocked([&] { return the_manager().removeTask(id); }); });
  module.def("manager_invoke", [](const py::object& function) {
    auto task = task_of(function);
    unlocked([&] { the_manager().invoke(std::move(task)); });
  });
  module.def("manager_string_to_components", [](const std::string& name) {
    const RTC::RTCList found = unlocked([&] { return the_manager().getNaming()->string_to_component(name); });
    py::list list;
    for (CORBA::ULong i = 0; i < found.length(); ++i)
      list.append(py::reinterpret_steal<py::object>(reference_out(found[i], "IDL:omg.org/RTC/RTObject:1.0")));
    return list;
  });
  module.def("manager_bind_object", [](const std::string& name, const py::object& stub) {
    const auto object = reference_in(stub.ptr());
    if (!object) throw py::type_error("no reference");
    unlocked([&] { the_manager().getNaming()->bindObject(name, *object); });
  });
}

void add_logger(py::module_& module) {
  py::class_<RTC::Logger>(module, "Logger")
      .def(py::init<const std::string&>())
      .def("getName", &RTC::Logger::getName)
      .def("setName", [](RTC::Logger& self, const std::string& name) { self.setName(name.c_str()); })
      .def("isValid", &RTC::Logger::isValid)
      .def("getLevel", &RTC::Logger::getLevel)
      .def("setLevel", py::overload_cast<int>(&RTC::Logger::setLevel))
      .def("_set_level", [](RTC::Logger& self, const std::string& level) { return self.setLevel(level.c_str()); })
      .def("_write", [](const RTC::Logger& self, int level, const std::string& text) { unlocked([&] { self.write(level, text); }); });
}

}  // namespace

void add_manager(py::module_& module) {
  add_life(module);
  add_modules_and_components(module);
  add_logger(module);
  // Seconds and nanoseconds of the clock in force: simulated time inside a tick.
  module.def("current_time", [] {
    const auto stamp = RTC::detail::current_stamp();
    return py::make_tuple(stamp.seconds, stamp.nanoseconds);
  });
  module.def("in_simulated_time", &RTC::inSimulatedTime);
}

}  // namespace python

#include "manager_listeners.h"

#include <rtm/Manager.h>
#include <rtm/ManagerActionListener.h>

#include "component.h"
#include "listeners.h"
#include "properties.h"

namespace py = pybind11;

namespace python {
namespace {

class Told {
 public:
  explicit Told(const py::object& function) : function_(function) {}

 protected:
  // `arguments` makes the tuple behind the event's name, with the lock.
  template <class... Arguments>
  void tell(const char* event, const Arguments&... arguments) {
    std::string problem;
    {
      const Locked locked;
      try {
        call(function_, py::make_tuple(event, shown(arguments)...));
        return;
      } catch (const Raised& raised) {
        problem = raised.what();
      } catch (py::error_already_set& error) {
        error.restore();
        problem = take_error();
      }
    }
    RTC::Logger("manager").write(RTC::Logger::RTL_ERROR, std::string("a listener to ") + event + " raised: " + problem);
  }

 private:
  static py::object shown(const std::string& text) { return py::str(text); }
  static py::object shown(RTC::RTObject_impl* component) { return python_component(component); }
  static py::object shown(const coil::Properties& properties) { return py::cast(Properties::copy_of(properties)); }
  static py::object shown(const coil::vstring& names) {
    py::list list;
    for (const auto& name : names) list.append(name);
    return list;
  }
  const Function function_;
};

class OfManager final : public RTM::ManagerActionListener, Told {
 public:
  using Told::Told;
  void preShutdown() override { tell("preShutdown"); }
  void postShutdown() override { tell("postShutdown"); }
  void preReinit() override { tell("preReinit"); }
  void postReinit() override { tell("postReinit"); }
};

class OfModules final : public RTM::ModuleActionListener, Told {
 public:
  using Told::Told;
  void preLoad(std::string& module, std::string& function) override { tell("preLoad", module, function); }
  void postLoad(std::string& module, std::string& function) override { tell("postLoad", module, function); }
  void preUnload(std::string& module) override { tell("preUnload", module); }
  void postUnload(std::string& module) override { tell("postUnload", module); }
};

class OfComponents final : public RTM::RtcLifecycleActionListener, Told {
 public:
  using Told::Told;
  void preCreate(std::string& arguments) override { tell("preCreate", arguments); }
  void postCreate(RTC::RTObject_impl* component) override { tell("postCreate", component); }
  void preConfigure(coil::Properties& properties) override { tell("preConfigure", properties); }
  void postConfigure(coil::Properties& properties) override { tell("postConfigure", properties); }
  void preInitialize() override { tell("preInitialize"); }
  void postInitialize() override { tell("postInitialize"); }
};

class OfNames final : public RTM::NamingActionListener, Told {
 public:
  using Told::Told;
  void preBind(RTC::RTObject_impl* component, coil::vstring& names) override { tell("preBind", component, names); }
  void postBind(RTC::RTObject_impl* component, coil::vstring& names) override { tell("postBind", component, names); }
  void preUnbind(RTC::RTObject_impl* component, coil::vstring& names) override { tell("preUnbind", component, names); }
  void postUnbind(RTC::RTObject_impl* component, coil::vstring& names) override { tell("postUnbind", component, names); }
};

template <class Listener, class Base>
auto adder(void (RTC::Manager::*add)(Base*, bool)) {
  return [add](const py::object& function) {
    auto* const listener = new Listener(function);
    RTC::Manager& manager = RTC::Manager::instance();
    unlocked([&] { (manager.*add)(listener, false); });  // it may be running when the manager ends
  };
}

}  // namespace

void add_manager_listeners(py::module_& module) {
  using RTC::Manager;
  module.def("manager_add_manager_listener", adder<OfManager>(&Manager::addManagerActionListener));
  module.def("manager_add_module_listener", adder<OfModules>(&Manager::addModuleActionListener));
  module.def("manager_add_lifecycle_listener", adder<OfComponents>(&Manager::addRtcLifecycleActionListener));
  module.def("manager_add_naming_listener", adder<OfNames>(&Manager::addNamingActionListener));
}

}  // namespace python

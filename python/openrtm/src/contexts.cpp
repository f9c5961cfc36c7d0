#include "contexts.h"

#include <pybind11/stl.h>
#include <rtm/ECFactory.h>
#include <rtm/ExtTrigExecutionContext.h>
#include <rtm/PeriodicExecutionContext.h>

#include <atomic>
#include <memory>
#include <string>

#include "component.h"
#include "context_hooks.h"
#include "convert.h"
#include "properties.h"
#include "references.h"

namespace py = pybind11;

namespace python {
namespace {

// Without a thread: that is the author's.
class Plain : public RTC::ExecutionContextServant<POA_OpenRTM::ExtTrigExecutionContextService> {
 public:
  explicit Plain(const std::string& name) : ExecutionContextServant(name) {
    setObjRef(RTC::ExecutionContextService_var(_this()));
    setKind(RTC::PERIODIC);
  }
  void tick() override { throw CORBA::NO_IMPLEMENT(0, CORBA::COMPLETED_NO); }
};

template <class Base>
constexpr bool has_loop = std::is_base_of_v<RTC::PeriodicExecutionContext, Base>;

// The one operation that differs: the loop of a periodic context, the tick of the others. When the loop has returned before the
// context is stopped, the thread that waits for a component to rest makes the transition.
template <class Base>
class Driven : public Base {
 public:
  using Base::Base;
  void tick() override {
    if (!hooks.has(Hook::tick)) return Base::tick();
    hooks.call(Hook::tick, "the tick is lost", [](PyObject*) {});
  }
  Hooks hooks;
  std::atomic<bool> loop_is_over{false};
};
template <class Base>
requires has_loop<Base>
class Driven<Base> : public Base {
 public:
  using Base::Base;
  int svc() override {
    if (!hooks.has(Hook::svc)) return Base::svc();
    loop_is_over = false;
    const bool has_returned = hooks.call(Hook::svc, "its components stand still", [](PyObject*) {});
    if (has_returned && this->threadRunning()) hooks.log(RTC::Logger::RTL_WARN, Hook::svc, "has returned; its components stand still");
    loop_is_over = true;
    return 0;
  }
  Hooks hooks;
  std::atomic<bool> loop_is_over{false};
};

template <class Base>
class Context final : public Driven<Base> {
 public:
  using Driven<Base>::Driven;
  using Driven<Base>::hooks;
  ~Context() override {
    if constexpr (has_loop<Base>) this->endThread();
  }
  void forget_self() { hooks.forget_self(); }
  // Without the lock: one that no factory has destroyed leaves the object adapter.
  void leave() {
    if (std::exchange(is_destroyed_, true)) return;
    this->_add_ref();
    RTC::destroyExecutionContext(this);
  }
  void destroy() {
    is_destroyed_ = true;
    RTC::destroyExecutionContext(this);
  }

  using Base::invokeWorker;
  using Base::invokeWorkerDo;
  using Base::invokeWorkerPostDo;
  using Base::invokeWorkerPreDo;
  void init(coil::Properties& properties) override {
    if (hooks.has(Hook::init))
      hooks.call(
          Hook::init, "options may be missing", [](PyObject*) {}, &properties);
    else
      Base::init(properties);
  }
  void base_init(coil::Properties& properties) { Base::init(properties); }
  RTC::ReturnCode_t base_started() { return Base::onStarted(); }
  RTC::ReturnCode_t base_stopping() { return Base::onStopping(); }
  void base_tick() { Base::tick(); }
  bool thread_running() const { return Base::threadRunning(); }
  int base_svc() { return Base::svc(); }

 protected:
  using Code = RTC::ReturnCode_t;
  using Component = RTC::LightweightRTObject_ptr;
  Code onStarting() override {
    return hooks.code(Hook::starting, [&] { return Base::onStarting(); });
  }
  Code onStarted() override {
    return hooks.code(Hook::started, [&] { return Base::onStarted(); });
  }
  Code onStopping() override {
    return hooks.code(Hook::stopping, [&] { return Base::onStopping(); });
  }
  Code onStopped() override {
    return hooks.code(Hook::stopped, [&] { return Base::onStopped(); });
  }
  double onGetRate(double rate) const override { return hooks.rate(Hook::get_rate, rate); }
  double onSettingRate(double rate) override { return hooks.rate(Hook::setting_rate, rate); }
  Code onSetRate(double rate) override {
    const Code code = Base::onSetRate(rate);
    return code != RTC::RTC_OK ? code : hooks.code(Hook::set_rate, ok, rate);
  }
  Code onAddingComponent(Component one) override { return hooks.code(Hook::adding, ok, one); }
  Code onAddedComponent(Component one) override { return hooks.code(Hook::added, ok, one); }
  Code onRemovingComponent(Component one) override { return hooks.code(Hook::removing, ok, one); }
  Code onRemovedComponent(Component one) override { return hooks.code(Hook::removed, ok, one); }
  Code onActivating(Component one) override { return hooks.code(Hook::activating, ok, one); }
  Code onDeactivating(Component one) override { return hooks.code(Hook::deactivating, ok, one); }
  Code onResetting(Component one) override { return hooks.code(Hook::resetting, ok, one); }
  Code onWaitingActivated(Machine* one, long count) override { return hooks.code(Hook::waiting_activated, ok, one, count); }
  Code onActivated(Machine* one, long count) override { return hooks.code(Hook::activated, ok, one, count); }
  Code onWaitingDeactivated(Machine* one, long count) override { return rested(Hook::waiting_deactivated, one, count); }
  Code onDeactivated(Machine* one, long count) override { return hooks.code(Hook::deactivated, ok, one, count); }
  Code onWaitingReset(Machine* one, long count) override { return rested(Hook::waiting_reset, one, count); }
  Code onReset(Machine* one, long count) override { return hooks.code(Hook::reset, ok, one, count); }

 private:
  static Code ok() { return RTC::RTC_OK; }
  Code rested(Hook hook, Machine* one, long count) {
    const Code code = hooks.code(hook, ok, one, count);
    if (!this->loop_is_over || is_stepping_.exchange(true)) return code;
    this->invokeWorkerPreDo();
    is_stepping_ = false;
    return code;
  }
  bool is_destroyed_ = false;
  std::atomic<bool> is_stepping_{false};
};

// --- factories

template <class Base>
RTC::ExecutionContextBase* taken(const py::object& object) {
  if (!py::isinstance<Context<Base>>(object)) return nullptr;
  auto& context = py::cast<Context<Base>&>(object);
  if (!context.hooks.self()) return nullptr;
  context.hooks.keep_self();
  context._add_ref();
  return &context;
}

RTC::ExecutionContextBase* create(const std::string& name, const Function& make) {
  std::string problem = "its class is derived from no context of OpenRTM_aist, or its __init__ does not call that of the base";
  {
    const Locked locked;
    try {
      const py::object object = call(make, py::tuple());
      if (auto* context = taken<Plain>(object)) return context;
      if (auto* context = taken<RTC::PeriodicExecutionContext>(object)) return context;
      if (auto* context = taken<RTC::ExtTrigExecutionContext>(object)) return context;
    } catch (const Raised& raised) {
      problem = raised.what();
    }
  }
  RTC::Logger("context").write(RTC::Logger::RTL_ERROR, "creating an execution context of type " + name + " failed: " + problem);
  return nullptr;
}

template <class Base>
bool destroyed(RTC::ExecutionContextBase* one) {
  auto* const context = dynamic_cast<Context<Base>*>(one);
  if (!context) return false;
  context->_add_ref();
  context->destroy();
  {
    const Locked locked;
    context->hooks.let_self_go();
  }
  context->_remove_ref();
  return true;
}

void destroy(RTC::ExecutionContextBase*& one) {
  if (!destroyed<Plain>(one) && !destroyed<RTC::PeriodicExecutionContext>(one)) destroyed<RTC::ExtTrigExecutionContext>(one);
  one = nullptr;
}

int add_factory(const std::string& name, const py::object& make) {
  const Function function(make);
  return static_cast<int>(unlocked([&] {
    return RTC::ExecutionContextFactory::instance().addFactory(
        name, [name, function] { return create(name, function); }, &destroy);
  }));
}

// --- for Python

py::object item_of(const char* enumeration, int number) {
  PyObject* const all = of_module("RTC", enumeration);
  if (!all) throw py::error_already_set();
  return py::handle(all).attr("_item")(number);
}
template <class Enum>
Enum number_of(const py::object& item) {
  return static_cast<Enum>(py::cast<int>(item.attr("_v")));
}

template <class Base>
using Class = py::class_<Context<Base>, std::shared_ptr<Context<Base>>>;

template <class Base>
void add_members(Class<Base>& cls) {
  using Self = Context<Base>;
  using Change = RTC::ReturnCode_t (RTC::ExecutionContextBase::*)(RTC::LightweightRTObject_ptr);
  const auto changing = [](Change change) {
    return [change](Self& self, const py::object& stub) {
      const auto object = reference_in(stub.ptr());
      if (!object) throw py::type_error("a reference of a component is expected, as of getObjRef()");
      return code_item(unlocked([&] {
        const RTC::LightweightRTObject_var component = RTC::LightweightRTObject::_narrow(*object);
        return (self.*change)(component);
      }));
    };
  };
  cls.def("addComponent", changing(&Self::addComponent))
      .def("removeComponent", changing(&Self::removeComponent))
      .def("activateComponent", changing(&Self::activateComponent))
      .def("deactivateComponent", changing(&Self::deactivateComponent))
      .def("resetComponent", changing(&Self::resetComponent))
      .def("getComponentState",
           [](Self& self, const py::object& stub) {
             const auto object = reference_in(stub.ptr());
             if (!object) throw py::type_error("a reference of a component is expected, as of getObjRef()");
             return item_of("LifeCycleState", unlocked([&] {
                              const RTC::LightweightRTObject_var component = RTC::LightweightRTObject::_narrow(*object);
                              return static_cast<int>(self.getComponentState(component));
                            }));
           })
      .def("getComponentList", [](Self& self) {
        py::list list;
        for (const auto& one : unlocked([&] { return self.getComponents(); })) list.append(argument(one.in()));
        return list;
      });
}

template <class Base>
void add_states(Class<Base>& cls) {
  using Self = Context<Base>;
  using Question = bool (RTC::ExecutionContextBase::*)(RTC::LifeCycleState) const;
  const auto asking = [](Question question) {
    return [question](Self& self, const py::object& state) {
      const auto wanted = number_of<RTC::LifeCycleState>(state);
      return unlocked([&] { return (self.*question)(wanted); });
    };
  };
  cls.def("isAllCurrentState", asking(&Self::isAllCurrentState))
      .def("isAllNextState", asking(&Self::isAllNextState))
      .def("isOneOfCurrentState", asking(&Self::isOneOfCurrentState))
      .def("isOneOfNextState", asking(&Self::isOneOfNextState))
      .def("isRunning", [](Self& self) { return self.isRunning(); })
      .def("getRate", [](Self& self) { return self.getRate(); })
      .def("_period", [](Self& self) { return std::chrono::duration<double>(self.getPeriod()).count(); })
      .def("setRate", [](Self& self, double rate) { return code_item(unlocked([&] { return self.setRate(rate); })); })
      .def("getKind", [](Self& self) { return item_of("ExecutionKind", static_cast<int>(self.getKind())); })
      .def("setKind", [](Self& self, const py::object& kind) { return code_item(self.setKind(number_of<RTC::ExecutionKind>(kind))); })
      .def("getName", [](Self& self) { return self.getName(); })
      .def("getProperties", [](Self& self) { return Properties::copy_of(self.getProperties()); })
      .def("setProperties", [](Self& self, const Properties& properties) { self.setProperties(*properties.node); })
      .def("getProfile",
           [](Self& self) {
             RTC::ExecutionContextProfile_var profile;
             unlocked([&] { profile = self.getProfile(); });
             return to_python(profile.in(), "IDL:omg.org/RTC/ExecutionContextProfile:1.0");
           })
      .def("getObjRef", [](Self& self) {
        CORBA::Object_var object;
        unlocked([&] { object = self.getObjRef(); });
        return py::reinterpret_steal<py::object>(reference_out(object, "IDL:omg.org/RTC/ExecutionContextService:1.0"));
      });
}

template <class Base, class Make>
Class<Base> add_context(py::module_& module, const char* name, Make make) {
  using Self = Context<Base>;
  Class<Base> cls(module, name);
  cls.def(py::init([make](const std::string& given) { return owned(unlocked([&] { return make(given); })); }), py::arg("name") = "")
      .def("_bind", [](Self& self, const py::object& object,
                       const std::vector<std::string>& overridden) { self.hooks.bind(object.ptr(), overridden); })
      .def("_rtm_loop_is_over", [](Self& self, bool is_over) { self.loop_is_over = is_over; })
      .def("init", [](Self& self, const Properties& properties) { unlocked([&] { self.base_init(*properties.node); }); })
      .def("start", [](Self& self) { return code_item(unlocked([&] { return self.start(); })); })
      .def("stop", [](Self& self) { return code_item(unlocked([&] { return self.stop(); })); })
      .def("invokeWorker", [](Self& self) { unlocked([&] { self.invokeWorker(); }); })
      .def("invokeWorkerPreDo", [](Self& self) { unlocked([&] { self.invokeWorkerPreDo(); }); })
      .def("invokeWorkerDo", [](Self& self) { unlocked([&] { self.invokeWorkerDo(); }); })
      .def("invokeWorkerPostDo", [](Self& self) { unlocked([&] { self.invokeWorkerPostDo(); }); })
      .def("onStarted", [](Self& self) { return code_item(unlocked([&] { return self.base_started(); })); })
      .def("onStopping", [](Self& self) { return code_item(unlocked([&] { return self.base_stopping(); })); });
  add_members<Base>(cls);
  add_states<Base>(cls);
  return cls;
}

void add_machine(py::module_& module) {
  const auto state = [](auto function) {
    return [function](const Machine& self) {
      return item_of("LifeCycleState", unlocked([&] { return static_cast<int>((self.*function)()); }));
    };
  };
  const auto doing = [](auto function) { return [function](Machine& self) { unlocked([&] { (self.*function)(); }); }; };
  py::class_<Machine>(module, "StateMachineOfComponent")
      .def("getRTObject",
           [](const Machine& self) {
             const RTC::LightweightRTObject_var component = self.getRTObject();
             return argument(component.in());
           })
      .def("getState", state(&Machine::getState))
      .def("getNextState", state(&Machine::getNextState))
      .def("isCurrentState",
           [](const Machine& self, const py::object& item) { return self.isCurrentState(number_of<RTC::LifeCycleState>(item)); })
      .def("isNextState",
           [](const Machine& self, const py::object& item) { return self.isNextState(number_of<RTC::LifeCycleState>(item)); })
      .def("workerPreDo", doing(&Machine::workerPreDo))
      .def("workerDo", doing(&Machine::workerDo))
      .def("workerPostDo", doing(&Machine::workerPostDo));
}

}  // namespace

void add_contexts(py::module_& module) {
  add_machine(module);
  using Loop = RTC::PeriodicExecutionContext;
  using Triggered = RTC::ExtTrigExecutionContext;
  add_context<Plain>(module, "PlainContext", [](const std::string& name) { return new Context<Plain>(name); });
  add_context<Loop>(module, "PeriodicContext", [](const std::string& name) {
    return name.empty() ? new Context<Loop>() : new Context<Loop>(name);
  }).def("svc", [](Context<Loop>& self) {
      return unlocked([&] { return self.base_svc(); });
    }).def("threadRunning", [](Context<Loop>& self) { return self.thread_running(); });
  add_context<Triggered>(module, "ExtTrigContext", [](const std::string&) {
    return new Context<Triggered>();
  }).def("tick", [](Context<Triggered>& self) { unlocked([&] { self.base_tick(); }); });
  module.def("context_add_factory", &add_factory);
  module.def("context_remove_factory", [](const std::string& name) {
    return static_cast<int>(unlocked([&] { return RTC::ExecutionContextFactory::instance().removeFactory(name); }));
  });
  module.def("context_identifiers", [] {
    return unlocked([] {
      RTC::registerBuiltinExecutionContexts();
      return RTC::ExecutionContextFactory::instance().getIdentifiers();
    });
  });
}

}  // namespace python

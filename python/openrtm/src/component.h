// A component written in Python: its callbacks are methods of the Python object.
//
// States: made (the Python object owns it), created (the factory keeps the Python object alive, too), destroyed by the factory (again only
// the Python object owns it; the runtime has let it go). Rights: self_ is read and written with the interpreter's lock. Failure cases: a
// callback that raises, or returns anything but RTC.RTC_OK, throws Raised: the runtime logs it and goes to the error state; after the
// Python object has died callbacks return RTC_ERROR.
#pragma once

#include <pybind11/pybind11.h>
#include <rtm/DataFlowComponentBase.h>

#include <memory>
#include <string>
#include <vector>

#include "gil.h"
#include "listeners.h"

namespace SDOPackage {
class PeriodicECOrganization;
}

namespace python {

class Component final : public RTC::DataFlowComponentBase {
 public:
  explicit Component(RTC::Manager* manager) : DataFlowComponentBase(manager) {}
  ~Component() override;

  // With the interpreter's lock: the Python object, not owned.
  void bind_self(PyObject* self);
  void forget_self() { self_ = nullptr; }
  // Without the lock: one that the runtime never took lets go of its place in the object adapter.
  void leave();
  PyObject* self() const { return self_; }
  // Keeps the Python object alive, until it is let go.
  void keep_self();
  void let_self_go();

  bool bind_parameter(const std::string& name, const std::string& default_value, const pybind11::object& function);
  void add_listener(int group, int type, const pybind11::object& function);
  // Of a composite; nullptr for others.
  void organize();
  SDOPackage::PeriodicECOrganization* organization() const { return organization_; }
  using RTObject_impl::m_configsets;
  using RTObject_impl::m_properties;

 protected:
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onFinalize() override;
  RTC::ReturnCode_t onStartup(RTC::UniqueId id) override;
  RTC::ReturnCode_t onShutdown(RTC::UniqueId id) override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId id) override;
  RTC::ReturnCode_t onAborting(RTC::UniqueId id) override;
  RTC::ReturnCode_t onError(RTC::UniqueId id) override;
  RTC::ReturnCode_t onReset(RTC::UniqueId id) override;
  RTC::ReturnCode_t onStateUpdate(RTC::UniqueId id) override;
  RTC::ReturnCode_t onRateChanged(RTC::UniqueId id) override;

 private:
  RTC::ReturnCode_t callback(PyObject* name, const RTC::UniqueId* id);

  PyObject* self_ = nullptr;
  bool is_kept_ = false;
  bool updates_state_ = true;  // the class has an onStateUpdate of its own
  std::vector<std::unique_ptr<Function>> bound_;
  SDOPackage::PeriodicECOrganization* organization_ = nullptr;  // a servant; this object holds one reference
};

// A new servant as its Python object owns it: when that dies, the servant forgets it and gives back the first reference.
template <class Servant>
std::shared_ptr<Servant> owned(Servant* servant) {
  return std::shared_ptr<Servant>(servant, [](Servant* last) {
    last->forget_self();
    unlocked([last] {
      last->leave();
      last->_remove_ref();
    });
  });
}

// The Python object of a component of Python, else a stub of it; None for nullptr. With the lock.
pybind11::object python_component(RTC::RTObject_impl* component);

void add_components(pybind11::module_& module);

}  // namespace python

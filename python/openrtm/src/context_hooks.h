// The methods of an execution context of Python that the runtime calls. Any thread; what a method raises is logged within the limits of
// complaint.h.
#pragma once

#include <pybind11/pybind11.h>
#include <rtm/ExecutionContextBase.h>
#include <rtm/SystemLogger.h>

#include <algorithm>
#include <array>
#include <bitset>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "complaint.h"
#include "convert.h"
#include "gil.h"
#include "properties.h"
#include "references.h"

namespace python {

namespace py = pybind11;

enum Hook : std::size_t {
  svc,
  tick,
  init,
  starting,
  started,
  stopping,
  stopped,
  get_rate,
  setting_rate,
  set_rate,
  adding,
  added,
  removing,
  removed,
  activating,
  waiting_activated,
  activated,
  deactivating,
  waiting_deactivated,
  deactivated,
  resetting,
  waiting_reset,
  reset,
  hook_count
};
inline constexpr std::array<const char*, hook_count> hook_names{"svc",
                                                                "tick",
                                                                "init",
                                                                "onStarting",
                                                                "onStarted",
                                                                "onStopping",
                                                                "onStopped",
                                                                "onGetRate",
                                                                "onSettingRate",
                                                                "onSetRate",
                                                                "onAddingComponent",
                                                                "onAddedComponent",
                                                                "onRemovingComponent",
                                                                "onRemovedComponent",
                                                                "onActivating",
                                                                "onWaitingActivated",
                                                                "onActivated",
                                                                "onDeactivating",
                                                                "onWaitingDeactivated",
                                                                "onDeactivated",
                                                                "onResetting",
                                                                "onWaitingReset",
                                                                "onReset"};

using Machine = RTC_impl::RTObjectStateMachine;

inline py::object argument(RTC::LightweightRTObject_ptr component) {
  return py::reinterpret_steal<py::object>(reference_out(component, "IDL:omg.org/RTC/LightweightRTObject:1.0"));
}
inline py::object argument(const Machine* machine) { return machine ? py::cast(Machine(*machine)) : py::object(py::none()); }
inline py::object argument(long count) { return py::int_(count); }
inline py::object argument(double rate) { return py::float_(rate); }
inline py::object argument(coil::Properties* properties) { return py::cast(Properties{nullptr, properties}); }

// Which methods the class overrides, and their calls. Without the lock, except for bind().
class Hooks {
 public:
  void bind(PyObject* self, const std::vector<std::string>& overridden) {
    self_ = self;
    class_name_ = Py_TYPE(self)->tp_name;
    for (std::size_t i = 0; i < hook_count; ++i)
      overridden_[i] = std::find(overridden.begin(), overridden.end(), hook_names[i]) != overridden.end();
  }
  PyObject* self() const { return self_; }
  void forget_self() { self_ = nullptr; }
  void keep_self() {
    if (self_ && !std::exchange(is_kept_, true)) Py_INCREF(self_);
  }
  void let_self_go() {
    if (std::exchange(is_kept_, false)) Py_DECREF(self_);
  }
  bool has(Hook hook) const { return overridden_[hook]; }

  // take(result) with the lock; false, and a log line, when something was raised.
  template <class Take, class... Arguments>
  bool call(Hook hook, const char* consequence, Take take, const Arguments&... arguments) const {
    std::optional<std::string> line;
    {
      const Locked locked;
      if (!self_) return false;
      const Ref self = Ref::borrowed(self_);
      std::string problem;
      try {
        const Ref method(PyObject_GetAttrString(self.get(), hook_names[hook]));
        const py::tuple tuple = py::make_tuple(argument(arguments)...);
        const Ref result(method ? PyObject_CallObject(method.get(), tuple.ptr()) : nullptr);
        if (result) {
          take(result.get());
          return true;
        }
        problem = take_error();
      } catch (const Raised& raised) {
        problem = raised.what();
      } catch (py::error_already_set& error) {
        error.restore();
        problem = take_error();
      } catch (const py::cast_error& error) {
        problem = error.what();
      }
      line = complaint_.next(std::string("failed; ") + consequence + ": " + problem);
    }
    if (line) log(RTC::Logger::RTL_ERROR, hook, *line);
    return false;
  }
  void log(int level, Hook hook, const std::string& text) const {
    RTC::Logger("context").write(level, class_name_ + "." + hook_names[hook] + "() of an execution context " + text);
  }

  template <class Base, class... Arguments>
  RTC::ReturnCode_t code(Hook hook, Base base, const Arguments&... arguments) const {
    if (!has(hook)) return base();
    RTC::ReturnCode_t code = RTC::RTC_ERROR;
    call(
        hook, "it counts as RTC_ERROR", [&](PyObject* result) { code = code_of_result(result); }, arguments...);
    return code;
  }
  double rate(Hook hook, double rate) const {
    double changed = rate;
    if (has(hook))
      call(
          hook, "the rate stays", [&](PyObject* result) { changed = py::cast<double>(py::handle(result)); }, rate);
    return changed;
  }

 private:
  PyObject* self_ = nullptr;
  bool is_kept_ = false;
  std::string class_name_;
  std::bitset<hook_count> overridden_;
  mutable Complaint complaint_;
};

}  // namespace python

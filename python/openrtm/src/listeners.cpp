#include "listeners.h"

#include <rtm/ByteData.h>

#include "complaint.h"
#include "convert.h"
#include "properties.h"

namespace py = pybind11;

namespace python {

py::object call(const Function& function, py::tuple arguments) {
  PyObject* const result = PyObject_Call(function.get(), arguments.ptr(), nullptr);
  if (!result) throw Raised(take_error());
  return py::reinterpret_steal<py::object>(result);
}

py::object python_info(const RTC::ConnectorInfo& info) {
  static PyObject* const cls = of_module("OpenRTM_aist.listeners", "ConnectorInfo");
  if (!cls) throw py::error_already_set();
  py::list ports;
  for (const auto& port : info.ports) ports.append(port);
  return py::reinterpret_borrow<py::object>(cls)(info.name, info.id, ports, py::cast(Properties::copy_of(info.properties)));
}

namespace {

RTC::ConnectorListenerStatus::Enum status_of(const py::object& result) {
  const long number = PyLong_Check(result.ptr()) ? PyLong_AsLong(result.ptr()) : 0;
  return number > 0 && number <= 3 ? static_cast<RTC::ConnectorListenerStatus::Enum>(number) : RTC::ConnectorListenerStatus::NO_CHANGE;
}

// Calls with the lock; NO_CHANGE for what is not logged, else Raised.
template <class Call>
RTC::ConnectorListenerStatus::Enum said_once(Complaint& complaint, Call call) {
  std::string problem;
  try {
    return call();
  } catch (const Raised& raised) {
    problem = raised.what();
  } catch (py::error_already_set& error) {
    error.restore();
    problem = take_error();
  }
  if (const auto line = complaint.next(problem)) throw Raised(*line);
  return RTC::ConnectorListenerStatus::NO_CHANGE;
}

class DataListener final : public RTC::ConnectorDataListener {
 public:
  explicit DataListener(const py::object& function) : function_(function) {}
  using ConnectorDataListener::operator();
  ReturnCode operator()(RTC::ConnectorInfo& info, RTC::ByteData& data, const std::string&) override {
    const Locked locked;
    return said_once(complaint_, [&] {
      const auto& octets = std::as_const(data);
      const py::bytes shown(reinterpret_cast<const char*>(octets.getBuffer()), octets.getDataLength());
      const py::object result = call(function_, py::make_tuple(python_info(info), shown, data.isLittleEndian()));
      if (!py::isinstance<py::tuple>(result)) return status_of(result);
      const py::tuple pair = py::reinterpret_borrow<py::tuple>(result);
      const std::string changed = py::cast<std::string>(pair[1]);
      data.writeData(reinterpret_cast<const unsigned char*>(changed.data()), changed.size());
      return status_of(pair[0]);
    });
  }

 private:
  const Function function_;
  Complaint complaint_;
};

class Listener final : public RTC::ConnectorListener {
 public:
  explicit Listener(const py::object& function) : function_(function) {}
  using ConnectorListener::operator();
  ReturnCode operator()(RTC::ConnectorInfo& info) override {
    const Locked locked;
    return said_once(complaint_, [&] { return status_of(call(function_, py::make_tuple(python_info(info)))); });
  }

 private:
  const Function function_;
  Complaint complaint_;
};

class Connection final : public RTC::ConnectionCallback {
 public:
  explicit Connection(const py::object& function) : function_(function) {}
  void operator()(RTC::ConnectorProfile& profile) override {
    const Locked locked;
    try {
      call(function_, py::make_tuple(to_python(profile, "IDL:omg.org/RTC/ConnectorProfile:1.0")));
    } catch (py::error_already_set& error) {
      error.restore();
      throw Raised(take_error());
    }
  }

 private:
  const Function function_;
};

}  // namespace

std::unique_ptr<RTC::ConnectorDataListener> make_data_listener(const py::object& function) {
  return std::make_unique<DataListener>(function);
}

std::unique_ptr<RTC::ConnectorListener> make_listener(const py::object& function) { return std::make_unique<Listener>(function); }

void set_connection_callback(RTC::PortBase& port, int which, const py::object& function) {
  using Set = void (RTC::PortBase::*)(RTC::ConnectionCallback*);
  static constexpr Set setters[] = {&RTC::PortBase::setOnPublishInterfaces, &RTC::PortBase::setOnSubscribeInterfaces,
                                    &RTC::PortBase::setOnConnected,         &RTC::PortBase::setOnUnsubscribeInterfaces,
                                    &RTC::PortBase::setOnDisconnected,      &RTC::PortBase::setOnConnectionLost};
  if (which < 0 || which >= static_cast<int>(std::size(setters))) throw py::index_error("no such callback");
  auto* callback = function.is_none() ? nullptr : new Connection(function);  // lives as long as the process: it may be running
  (port.*setters[which])(callback);
}

}  // namespace python

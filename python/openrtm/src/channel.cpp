#include "channel.h"

#include "convert.h"

namespace py = pybind11;

namespace python {
namespace {

const char* const profile_id = "IDL:omg.org/RTC/ConnectorProfile:1.0";

// Calls with the lock; the text of what was raised, or empty.
template <class Call>
std::string problem_of(Call call) {
  const Locked locked;
  try {
    call();
    return {};
  } catch (const Raised& raised) {
    return raised.what();
  } catch (py::error_already_set& error) {
    error.restore();
    return take_error();
  } catch (const py::cast_error& problem) {
    return problem.what();
  }
}

}  // namespace

ChannelPort::ChannelPort(const std::string& name, const py::object& publish, const py::object& subscribe, const py::object& unsubscribe)
    : PortBase(name.c_str()), publish_(publish), subscribe_(subscribe), unsubscribe_(unsubscribe) {}

void ChannelPort::complain(const char* what, const std::string& problem) {
  RTC_ERROR(("%s of port %s raised: %s", what, getName(), problem.c_str()));
}

RTC::ReturnCode_t ChannelPort::publishInterfaces(RTC::ConnectorProfile& profile) {
  std::vector<std::pair<std::string, std::string>> added;
  bool is_refused = false;
  const std::string problem = problem_of([&] {
    const py::object list = call(publish_, py::make_tuple(to_python(profile, profile_id)));
    is_refused = list.is_none();
    if (is_refused) return;
    for (const auto& pair : list) {
      const auto item = py::reinterpret_borrow<py::tuple>(pair);
      added.emplace_back(py::cast<std::string>(item[0]), py::cast<std::string>(item[1]));
    }
  });
  if (!problem.empty()) {
    complain("publish", problem);
    return RTC::RTC_ERROR;
  }
  if (is_refused) return RTC::BAD_PARAMETER;
  for (const auto& [key, text] : added) CORBA_SeqUtil::push_back(profile.properties, NVUtil::newNV(key.c_str(), text));
  return RTC::RTC_OK;
}

RTC::ReturnCode_t ChannelPort::subscribeInterfaces(const RTC::ConnectorProfile& profile) {
  bool is_done = false;
  const std::string problem =
      problem_of([&] { is_done = call(subscribe_, py::make_tuple(to_python(profile, profile_id))).is(py::bool_(true)); });
  if (!problem.empty()) complain("subscribe", problem);
  return is_done ? RTC::RTC_OK : RTC::RTC_ERROR;
}

void ChannelPort::unsubscribeInterfaces(const RTC::ConnectorProfile& profile) {
  const std::string problem = problem_of([&] { call(unsubscribe_, py::make_tuple(py::str(profile.connector_id.in()))); });
  if (!problem.empty()) complain("unsubscribe", problem);
}

void add_channels(py::module_& module) {
  py::class_<ChannelPort, RTC::PortBase, std::shared_ptr<ChannelPort>>(module, "ChannelPort")
      .def(py::init([](const std::string& name, const py::object& publish, const py::object& subscribe, const py::object& unsubscribe) {
        return std::shared_ptr<ChannelPort>(new ChannelPort(name, publish, subscribe, unsubscribe),
                                            [](ChannelPort* port) { unlocked([&] { delete port; }); });
      }))
      .def("setConnectionLimit", &ChannelPort::setConnectionLimit);
}

}  // namespace python

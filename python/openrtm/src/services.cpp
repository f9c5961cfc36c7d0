#include "services.h"

#include <rtm/CorbaPort.h>

#include "calls.h"
#include "component.h"
#include "references.h"

namespace py = pybind11;

namespace python {
namespace {

// Hands the references to functions of Python: set(stub) -> bool, and release().
class ServiceConsumer final : public RTC::CorbaConsumerBase {
 public:
  ServiceConsumer(const py::object& set, const py::object& release) : set_(set), release_(release) {}

  bool setObject(CORBA::Object_ptr object) override {
    if (!CorbaConsumerBase::setObject(object)) return false;
    return told(set_, [&] { return py::make_tuple(py::reinterpret_steal<py::object>(reference_out(getObject(), ""))); });
  }
  void releaseObject() override {
    CorbaConsumerBase::releaseObject();
    told(release_, [] { return py::tuple(); });
  }

 private:
  template <class Arguments>
  bool told(const Function& function, Arguments arguments) {
    std::string problem;
    {
      const Locked locked;
      try {
        return call(function, arguments()).is(py::bool_(true));
      } catch (const Raised& raised) {
        problem = raised.what();
      } catch (py::error_already_set& error) {
        error.restore();
        problem = take_error();
      }
    }
    RTC::Logger("service").write(RTC::Logger::RTL_ERROR, "a consumer cannot take its object: " + problem);
    return false;
  }
  const Function set_, release_;
};

// Keeps what has been registered.
class ServicePort final : public RTC::CorbaPort {
 public:
  explicit ServicePort(const std::string& name) : CorbaPort(name.c_str()) {}
  using PortBase::setConnectionLimit;
  std::vector<std::unique_ptr<ServiceConsumer>> consumers;
};

}  // namespace

void add_services(py::module_& module) {
  py::class_<ServicePort, RTC::PortBase, std::shared_ptr<ServicePort>>(module, "CorbaPort")
      .def(py::init([](const std::string& name) {
        return std::shared_ptr<ServicePort>(new ServicePort(name), [](ServicePort* port) { unlocked([&] { delete port; }); });
      }))
      .def("setConnectionLimit", &ServicePort::setConnectionLimit)
      .def("_register_provider",
           [](ServicePort& port, const std::string& instance, const std::string& type, Servant& servant) {
             servant.keep_self();
             return unlocked([&] { return port.registerProvider(instance.c_str(), type.c_str(), servant); });
           })
      .def("_register_consumer",
           [](ServicePort& port, const std::string& instance, const std::string& type, const py::object& set, const py::object& release) {
             port.consumers.push_back(std::make_unique<ServiceConsumer>(set, release));
             ServiceConsumer& consumer = *port.consumers.back();
             return unlocked([&] { return port.registerConsumer(instance.c_str(), type.c_str(), consumer); });
           });
}

}  // namespace python

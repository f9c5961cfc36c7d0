#include "sdo.h"

#include <rtm/SdoServiceConsumerBase.h>
#include <rtm/SdoServiceProviderBase.h>

#include <memory>
#include <string>

#include "calls.h"
#include "convert.h"

namespace py = pybind11;

namespace python {
namespace {

const char* const service_profile_id = "IDL:org.omg/SDOPackage/ServiceProfile:1.0";

// Python object with the methods of a service; the same for both directions. Without the lock.
class ServiceObject {
 public:
  explicit ServiceObject(const py::object& object) : object_(object) {}

  bool init(RTC::RTObject_impl& component, const SDOPackage::ServiceProfile& profile) {
    profile_ = profile;
    return told("init", [&] { return py::make_tuple(python_component(&component), to_python(profile, service_profile_id)); });
  }
  bool reinit(const SDOPackage::ServiceProfile& profile) {
    profile_ = profile;
    return told("reinit", [&] { return py::make_tuple(to_python(profile, service_profile_id)); });
  }
  const SDOPackage::ServiceProfile& profile() const { return profile_; }
  void finalize() {
    told("finalize", [] { return py::tuple(); });
  }

 private:
  template <class Arguments>
  bool told(const char* name, Arguments arguments) {
    std::string problem;
    {
      const Locked locked;
      try {
        const py::object method = py::getattr(py::handle(object_.get()), name);
        const py::object result = py::reinterpret_steal<py::object>(PyObject_Call(method.ptr(), arguments().ptr(), nullptr));
        if (result) return PyObject_IsTrue(result.ptr()) == 1;
        problem = take_error();
      } catch (py::error_already_set& error) {
        error.restore();
        problem = take_error();
      }
    }
    RTC::Logger("sdo").write(RTC::Logger::RTL_ERROR, std::string(name) + " of an SDO service raised: " + problem);
    return false;
  }

  const Function object_;
  SDOPackage::ServiceProfile profile_;
};

class Consumer final : public RTC::SdoServiceConsumerBase {
 public:
  explicit Consumer(const py::object& object) : object_(object) {}
  bool init(RTC::RTObject_impl& component, const SDOPackage::ServiceProfile& profile) override { return object_.init(component, profile); }
  bool reinit(const SDOPackage::ServiceProfile& profile) override { return object_.reinit(profile); }
  const SDOPackage::ServiceProfile& getProfile() const override { return object_.profile(); }
  void finalize() override { object_.finalize(); }

 private:
  ServiceObject object_;
};

// What the runtime calls; calls from elsewhere go on to the servant of the Python object.
class Provider final : public RTC::SdoServiceProviderBase {
 public:
  Provider(const py::object& object, Servant& servant) : object_(object), servant_(servant) { servant.keep_self(); }
  bool init(RTC::RTObject_impl& component, const SDOPackage::ServiceProfile& profile) override { return object_.init(component, profile); }
  bool reinit(const SDOPackage::ServiceProfile& profile) override { return object_.reinit(profile); }
  const SDOPackage::ServiceProfile& getProfile() const override { return object_.profile(); }
  void finalize() override { object_.finalize(); }

  CORBA::Boolean _dispatch(omniCallHandle& handle) override { return servant_._dispatch(handle); }
  const char* _mostDerivedRepoId() override { return servant_._mostDerivedRepoId(); }
  CORBA::Boolean _is_a(const char* id) override { return servant_._is_a(id); }
  void* _ptrToInterface(const char*) override { return nullptr; }

 private:
  ServiceObject object_;
  Servant& servant_;  // kept
};

Provider* provider_of(const py::object& object) {
  const py::object servant = object.attr("_core_servant")();
  return new Provider(object, py::cast<Servant&>(servant));
}

// Makes the Python object of a factory; nullptr, and the reason in the log, when that fails.
template <class Made>
auto maker(const py::object& create, Made made) {
  return [function = Function(create), made]() -> decltype(made(py::object())) {
    std::string problem;
    {
      const Locked locked;
      try {
        return made(call(function, py::tuple()));
      } catch (const Raised& raised) {
        problem = raised.what();
      } catch (py::error_already_set& error) {
        error.restore();
        problem = take_error();
      }
    }
    RTC::Logger("sdo").write(RTC::Logger::RTL_ERROR, "an SDO service cannot be made: " + problem);
    return nullptr;
  };
}

int add_consumer_factory(const std::string& id, const py::object& create) {
  auto make = maker(create, [](const py::object& object) -> RTC::SdoServiceConsumerBase* { return new Consumer(object); });
  return static_cast<int>(unlocked([&] {
    return RTC::SdoServiceConsumerFactory::instance().addFactory(id, std::move(make), [](RTC::SdoServiceConsumerBase*& one) {
      delete one;
      one = nullptr;
    });
  }));
}

int add_provider_factory(const std::string& id, const py::object& create) {
  auto make = maker(create, [](const py::object& object) -> RTC::SdoServiceProviderBase* { return provider_of(object); });
  return static_cast<int>(unlocked([&] {
    return RTC::SdoServiceProviderFactory::instance().addFactory(id, std::move(make), [](RTC::SdoServiceProviderBase*& one) {
      one->_remove_ref();
      one = nullptr;
    });
  }));
}

template <class Factory>
void add_factory(py::module_& module, const std::string& prefix, int (*add)(const std::string&, const py::object&)) {
  module.def((prefix + "_add_factory").c_str(), add);
  module.def((prefix + "_remove_factory").c_str(),
             [](const std::string& id) { return static_cast<int>(unlocked([&] { return Factory::instance().removeFactory(id); })); });
  module.def((prefix + "_identifiers").c_str(), [] {
    py::list list;
    for (const auto& id : unlocked([] { return Factory::instance().getIdentifiers(); })) list.append(id);
    return list;
  });
}

}  // namespace

void add_sdo_of_components(py::class_<Component, std::shared_ptr<Component>>& cls) {
  cls.def("addSdoServiceProvider",
          [](Component& self, const py::object& profile, const py::object& provider) {
            const auto said = from_python<SDOPackage::ServiceProfile>(profile, service_profile_id);
            Provider* const made = provider_of(provider);
            return unlocked([&] {
              const bool is_added = self.addSdoServiceProvider(said, made);
              if (!is_added) made->_remove_ref();
              return is_added;
            });
          })
      .def("removeSdoServiceProvider",
           [](Component& self, const std::string& id) { return unlocked([&] { return self.removeSdoServiceProvider(id.c_str()); }); })
      .def("addSdoServiceConsumer",
           [](Component& self, const py::object& profile) {
             const auto said = from_python<SDOPackage::ServiceProfile>(profile, service_profile_id);
             return unlocked([&] { return self.addSdoServiceConsumer(said); });
           })
      .def("removeSdoServiceConsumer",
           [](Component& self, const std::string& id) { return unlocked([&] { return self.removeSdoServiceConsumer(id.c_str()); }); });
}

void add_sdo(py::module_& module) {
  add_factory<RTC::SdoServiceConsumerFactory>(module, "sdo_consumer", &add_consumer_factory);
  add_factory<RTC::SdoServiceProviderFactory>(module, "sdo_provider", &add_provider_factory);
}

}  // namespace python

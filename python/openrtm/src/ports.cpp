#include "ports.h"

#include <rtm/EventPort.h>

#include <cstring>
#include <map>

#include "listeners.h"
#include "properties.h"
#include "references.h"
#include "serializers.h"

namespace py = pybind11;

namespace python {
namespace {

// For the table of functions, which has no room for a type: the type that is being described on this thread.
thread_local const Type* described_type = nullptr;

std::shared_ptr<void> make_value() { return std::make_shared<Value>(); }
std::shared_ptr<void> copy_value(const void* value) { return std::make_shared<Value>(*static_cast<const Value*>(value)); }
void assign_value(void* to, const void* from) { *static_cast<Value*>(to) = *static_cast<const Value*>(from); }

bool is_little(bool swaps) { return swaps != (std::endian::native == std::endian::little); }

void put_value(const void* from, cdrStream& stream) {
  const auto& value = *static_cast<const Value*>(from);
  const bool wanted = is_little(stream.marshal_byte_swap());
  std::shared_ptr<const Octets> octets = value.octets;
  if (wanted != value.is_little) {
    if (!value.type) throw CORBA::MARSHAL();
    const Locked locked;
    auto other = std::make_shared<Octets>();
    try {
      const Ref object(decode(*value.type, *octets, value.is_little));
      encode(*value.type, object.get(), wanted, *other);
    } catch (const BadOctets&) {
      throw CORBA::MARSHAL();
    } catch (const BadValue&) {
      throw CORBA::MARSHAL();
    } catch (const PythonFailed&) {
      PyErr_Clear();
      throw CORBA::MARSHAL();
    }
    octets = other;
    if (!octets->empty())
      for (std::byte one : *octets) stream.marshalOctet(static_cast<CORBA::Octet>(one));
    return;
  }
  if (!octets->empty()) stream.put_octet_array(reinterpret_cast<const CORBA::Octet*>(octets->data()), static_cast<int>(octets->size()));
}

// All that is left in the stream.
void get_value(void* to, cdrStream& stream) {
  auto& value = *static_cast<Value*>(to);
  CORBA::ULong size = 0;
  for (CORBA::ULong step = 1U << 30; step > 0; step /= 2)
    if (stream.checkInputOverrun(1, size + step)) size += step;
  auto octets = std::make_shared<Octets>(size);
  if (size) stream.get_octet_array(reinterpret_cast<CORBA::Octet*>(octets->data()), static_cast<int>(size));
  value.octets = std::move(octets);
  value.is_little = is_little(stream.unmarshal_byte_swap());
  value.type = nullptr;
}

// The first member of types with a time stamp is `tm`.
void stamp_value(void* to, CORBA::ULong seconds, CORBA::ULong nanoseconds) {
  auto& value = *static_cast<Value*>(to);
  auto changed = std::make_shared<Octets>(*value.octets);
  if (changed->size() < 8) return;
  const bool swaps = value.is_little != (std::endian::native == std::endian::little);
  const CORBA::ULong numbers[2] = {swaps ? __builtin_bswap32(seconds) : seconds, swaps ? __builtin_bswap32(nanoseconds) : nanoseconds};
  std::memcpy(changed->data(), numbers, sizeof numbers);
  value.octets = std::move(changed);
}

bool has_stamp(const Type& type) {
  if (type.kind != CORBA::tk_struct || type.members.empty()) return false;
  return PyUnicode_CompareWithASCIIString(type.members[0].name, "tm") == 0 && actual(*type.members[0].type).id == "IDL:RTC/Time:1.0";
}

const Type& checked_type(py::handle value) {
  const Type* type = type_of_value(value.ptr());
  if (!type) throw py::error_already_set();
  return *type;
}

}  // namespace

const RTC::detail::DataType& data_type_of(const Type& type) {
  static auto& known = *new std::map<const Type*, std::unique_ptr<RTC::detail::DataType>>;
  auto& made = known[&type];
  if (!made) {
    described_type = &type;
    made = std::make_unique<RTC::detail::DataType>(RTC::detail::TypeTable{[] { return code_of(*described_type); }, &typeid(Value),
                                                                          &make_value, &copy_value, &assign_value, &put_value, &get_value,
                                                                          has_stamp(type) ? &stamp_value : nullptr});
  }
  return *made;
}

InPort::InPort(const std::string& name, py::object value) : InPort(name, value, checked_type(value)) {}

InPort::InPort(const std::string& name, py::object value, const Type& type)
    : InPortBase(name.c_str(), data_type_of(type), serializers_of(type)), last(std::move(value)), type_(type) {}

bool InPort::read(std::string name) {
  const Locked locked;
  const auto self = py::cast(this, py::return_value_policy::reference);
  try {
    self.attr("read")(name);
    return true;
  } catch (py::error_already_set& error) {
    error.restore();
    throw Raised(take_error());
  }
}

EventPort::EventPort(const std::string& name) : InPortBase(name.c_str(), RTC::detail::DataType::any(), RTC::detail::any_serializers()) {}

bool InPort::is_new(py::object names) {
  if (names.is_none()) return unlocked([&] { return isNew(); });
  if (py::isinstance<py::str>(names)) {
    const std::string name = py::cast<std::string>(names);
    return unlocked([&] { return isNew(name); });
  }
  coil::vstring found;
  unlocked([&] { return isNew(found); });
  names.attr("clear")();
  for (const auto& name : found) names.attr("append")(name);
  return !found.empty();
}

py::object InPort::read_value(const std::string& name) {
  Value value;
  if (unlocked([&] { return readValue(name, &value); })) {
    try {
      last = py::reinterpret_steal<py::object>(decode(type_, *value.octets, value.is_little));
    } catch (const BadOctets&) {
      if (const auto line = complaint_.next("a sample is no " + name_of(type_))) unlocked([&] { RTC_ERROR(("%s", line->c_str())); });
    } catch (const PythonFailed&) {
      throw py::error_already_set();
    }
  }
  return last;
}

OutPort::OutPort(const std::string& name, py::object value) : OutPort(name, value, checked_type(value)) {}

OutPort::OutPort(const std::string& name, py::object value, const Type& type)
    : OutPortBase(name.c_str(), data_type_of(type), serializers_of(type)), bound(std::move(value)), type_(type) {}

bool OutPort::write() {
  const Locked locked;
  const auto self = py::cast(this, py::return_value_policy::reference);
  try {
    return py::cast<bool>(self.attr("write")());
  } catch (py::error_already_set& error) {
    error.restore();
    throw Raised(take_error());
  }
}

bool OutPort::write_value(py::object object) {
  if (object.is_none()) object = bound;
  Value value;
  value.type = &type_;
  auto octets = std::make_shared<Octets>();
  try {
    encode(type_, object.ptr(), true, *octets);
  } catch (const BadValue& bad) {
    complain(bad);
    return false;
  } catch (const PythonFailed&) {
    throw py::error_already_set();
  } catch (const CORBA::Exception& problem) {
    complain({{}, name_of(type_), std::string("what cannot be encoded: ") + problem._name()});
    return false;
  }
  value.octets = std::move(octets);
  return unlocked([&] { return writeValue(&value); });
}

void OutPort::complain(const BadValue& bad) {
  const auto line = complaint_.next("a " + name_of(type_) + " cannot be written to port " + getName() + ": " + bad.text());
  if (line) unlocked([&] { RTC_ERROR(("%s", line->c_str())); });
}

namespace {

py::object& value_of(InPort& port) { return port.last; }
py::object& value_of(OutPort& port) { return port.bound; }

// Ports are destroyed without the lock: their last callers may want it.
template <class Port>
std::shared_ptr<Port> made(const std::string& name, const py::object& value) {
  return std::shared_ptr<Port>(new Port(name, value), [](Port* port) {
    const Ref last(value_of(*port).release().ptr());
    unlocked([&] { delete port; });
  });
}

}  // namespace

void add_ports(py::module_& module) {
  using RTC::PortBase;
  py::class_<PortBase, std::shared_ptr<PortBase>>(module, "PortBase")
      .def("getName", &PortBase::getName)
      .def("setName", [](PortBase& port, const std::string& name) { port.setName(name.c_str()); })
      .def("addProperty",
           [](PortBase& port, const std::string& key, py::object value) {
             const std::string text = py::str(value);
             const Released released;
             port.addProperty(key.c_str(), text.c_str());
           })
      .def("appendProperty",
           [](PortBase& port, const std::string& key, py::object value) {
             const std::string text = py::str(value);
             const Released released;
             return port.appendProperty(key.c_str(), text.c_str());
           })
      .def("_reference",
           [](PortBase& port) {
             CORBA::Object_var object;
             unlocked([&] { object = CORBA::Object::_duplicate(port.getPortRef()); });
             return py::reinterpret_steal<py::object>(reference_out(object, "IDL:omg.org/RTC/PortService:1.0"));
           })
      .def(
          "properties",
          [](PortBase& port) {
            return Properties{nullptr, &port.properties()};
          },
          py::keep_alive<0, 1>())
      .def("_deactivate", [](PortBase& port) { unlocked([&] { port.deactivate(); }); })
      .def("_on_connection", &set_connection_callback)
      .def("disconnect",
           [](PortBase& port, const std::string& id) { return static_cast<int>(unlocked([&] { return port.disconnect(id.c_str()); })); })
      .def("_disconnect_all", [](PortBase& port) { return static_cast<int>(unlocked([&] { return port.disconnect_all(); })); });

  using RTC::InPortBase;
  py::class_<InPortBase, PortBase, std::shared_ptr<InPortBase>>(module, "InPortBase")
      .def("_add_data_listener", &add_data_listener<InPortBase>)
      .def("_add_listener", &add_listener<InPortBase>)
      .def("_connectors", &connectors_of<InPortBase>);
  py::class_<InPort, InPortBase, std::shared_ptr<InPort>>(module, "InPort")
      .def(py::init(&made<InPort>), py::arg("name"), py::arg("value"))
      .def("isNew", &InPort::is_new, py::arg("names") = py::none())
      .def("_read", &InPort::read_value)
      .def("_read_default", [](InPort& port) { return port.read_value({}); })
      .def("_type_id", [](InPort& port) { return port.type().id; })
      .def("_descriptor", [](InPort& port) { return py::reinterpret_borrow<py::object>(port.type().descriptor); })
      .def("setConnectionLimit", &InPort::setConnectionLimit)
      .def_readwrite("_value", &InPort::last);
  py::class_<EventPort, InPortBase, std::shared_ptr<EventPort>>(module, "EventPort")
      .def(py::init([](const std::string& name) {
        return std::shared_ptr<EventPort>(new EventPort(name), [](EventPort* port) { unlocked([&] { delete port; }); });
      }))
      .def("setConnectionLimit", &EventPort::setConnectionLimit);
  py::class_<OutPort, PortBase, std::shared_ptr<OutPort>>(module, "OutPort")
      .def(py::init(&made<OutPort>), py::arg("name"), py::arg("value"))
      .def("_write", &OutPort::write_value)
      .def("_statuses",
           [](OutPort& port) {
             py::list all;
             for (const auto& status : port.getStatusList()) all.append(static_cast<int>(static_cast<RTC::DataPortStatus::Enum>(status)));
             return all;
           })
      .def("_type_id", [](OutPort& port) { return port.type().id; })
      .def("_descriptor", [](OutPort& port) { return py::reinterpret_borrow<py::object>(port.type().descriptor); })
      .def("_add_data_listener", &add_data_listener<OutPort>)
      .def("_add_listener", &add_listener<OutPort>)
      .def("_connectors", &connectors_of<OutPort>)
      .def("setConnectionLimit", &OutPort::setConnectionLimit)
      .def_readwrite("_value", &OutPort::bound);
}

}  // namespace python

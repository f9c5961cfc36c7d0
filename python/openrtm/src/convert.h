// Values of the generated C++ types as Python objects of the stubs, and back, by way of their bytes. With the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>
#include <rtm/idl/RTCStub.h>

#include "coder.h"

namespace python {

inline const Type& type_by_id(const char* id) {
  PyObject* const descriptor = registered("typeMapping", id);
  const Type* type = descriptor ? type_of(descriptor) : nullptr;
  if (!type) throw pybind11::error_already_set();
  return *type;
}

template <class Value>
pybind11::object to_python(const Value& value, const char* id) {
  cdrMemoryStream stream;
  value >>= stream;
  try {
    return pybind11::reinterpret_steal<pybind11::object>(decode(type_by_id(id), stream));
  } catch (const PythonFailed&) {
    throw pybind11::error_already_set();
  } catch (const BadOctets&) {
    throw pybind11::type_error(std::string("a value is no ") + id);
  }
}

// A TypeError names the member that does not fit.
template <class Value>
Value from_python(const pybind11::object& object, const char* id) {
  cdrMemoryStream stream;
  try {
    encode(type_by_id(id), object.ptr(), stream);
  } catch (const PythonFailed&) {
    throw pybind11::error_already_set();
  } catch (const BadValue& bad) {
    throw pybind11::type_error(bad.text());
  }
  Value value;
  value <<= stream;
  return value;
}

// RTC.ReturnCode_t and back; Raised when the object is none.
pybind11::object code_item(RTC::ReturnCode_t code);
RTC::ReturnCode_t code_of_result(PyObject* result);

}  // namespace python

#include "python/src/arguments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "python/src/errors.h"

namespace python {
namespace {

[[noreturn]] void refuse(const char* what, const std::string& expected, py::handle value) {
  throw Error(std::string(what) + ": expected " + expected + ", got " + shown(value));
}

// A conversion of Python has raised: what does not fit is rejected, and anything else goes on, as KeyboardInterrupt.
[[noreturn]] void refuse_raised(const char* what, const std::string& expected, py::handle value) {
  for (PyObject* const one : {PyExc_TypeError, PyExc_ValueError, PyExc_ArithmeticError, PyExc_AttributeError}) {
    if (!PyErr_ExceptionMatches(one)) continue;
    PyErr_Clear();
    refuse(what, expected, value);
  }
  throw py::error_already_set();
}

bool is_text(py::handle value) { return PyUnicode_Check(value.ptr()) || PyBytes_Check(value.ptr()) || PyByteArray_Check(value.ptr()); }

double number_of(const char* what, py::handle value, const char* expected) {
  if (PyFloat_CheckExact(value.ptr())) return PyFloat_AS_DOUBLE(value.ptr());
  if (is_text(value)) refuse(what, expected, value);
  const double found = PyFloat_AsDouble(value.ptr());
  if (found == -1 && PyErr_Occurred()) refuse_raised(what, expected, value);
  return found;
}

}  // namespace

std::string shown(py::handle value) {
  constexpr std::size_t longest = 60;
  const auto repr = py::reinterpret_steal<py::object>(PyObject_Repr(value.ptr()));
  const char* const utf8 = repr ? PyUnicode_AsUTF8(repr.ptr()) : nullptr;
  if (!utf8) {
    PyErr_Clear();
    return std::string("a ") + Py_TYPE(value.ptr())->tp_name;
  }
  std::string line = utf8;
  std::replace(line.begin(), line.end(), '\n', ' ');
  if (line.size() <= longest) return line;
  std::size_t end = longest;
  while ((static_cast<unsigned char>(line[end]) & 0xC0) == 0x80) --end;  // not within a character
  return line.substr(0, end) + "...";
}

double number(const char* what, py::handle value) {
  const double found = number_of(what, value, "a finite number");
  if (!std::isfinite(found)) refuse(what, "a finite number", value);
  return found;
}

std::chrono::duration<double> seconds(const char* what, py::handle value) {
  const double found = number_of(what, value, "seconds, 0 or more");
  if (!(found >= 0)) refuse(what, "seconds, 0 or more", value);
  return std::chrono::duration<double>(std::min(found, 1e9));
}

namespace {

py::object index_of(const char* what, py::handle value, const std::string& expected) {
  if (PyFloat_Check(value.ptr()) && std::floor(PyFloat_AS_DOUBLE(value.ptr())) == PyFloat_AS_DOUBLE(value.ptr())) {
    auto rounded = py::reinterpret_steal<py::object>(PyLong_FromDouble(PyFloat_AS_DOUBLE(value.ptr())));
    if (rounded) return rounded;
    refuse_raised(what, expected, value);
  }
  auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index) refuse_raised(what, expected, value);
  return index;
}

}  // namespace

std::int64_t whole(const char* what, py::handle value, std::int64_t lowest, std::int64_t highest) {
  const bool has_limit = highest != std::numeric_limits<std::int64_t>::max();
  const std::string expected = has_limit ? "a whole number from " + std::to_string(lowest) + " to " + std::to_string(highest)
                                         : "a whole number of at least " + std::to_string(lowest);
  const py::object index = index_of(what, value, expected);
  int overflow = 0;
  const long long found = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
  if (overflow != 0 || found < lowest || found > highest) refuse(what, expected, value);
  return found;
}

std::uint64_t seed(py::handle value) {
  const std::string expected = "a whole number from 0 to 2^64 - 1";
  const py::object index = index_of("seed", value, expected);
  const unsigned long long found = PyLong_AsUnsignedLongLong(index.ptr());
  if (found == ~0ULL && PyErr_Occurred()) refuse_raised("seed", expected, value);
  return found;
}

std::vector<double> numbers(const char* what, py::handle value, std::initializer_list<std::size_t> counts) {
  std::string expected;
  for (const std::size_t count : counts) expected += (expected.empty() ? "" : " or ") + std::to_string(count);
  expected += expected.empty() ? "numbers" : " numbers";
  if (is_text(value)) refuse(what, expected, value);
  const auto list = py::reinterpret_steal<py::object>(PySequence_Fast(value.ptr(), ""));
  if (!list) refuse_raised(what, expected, value);
  const auto size = static_cast<std::size_t>(PySequence_Fast_GET_SIZE(list.ptr()));
  if (counts.size() > 0 && std::find(counts.begin(), counts.end(), size) == counts.end()) refuse(what, expected, value);
  std::vector<double> found(size);
  for (std::size_t i = 0; i < size; ++i) found[i] = number(what, PySequence_Fast_GET_ITEM(list.ptr(), static_cast<Py_ssize_t>(i)));
  return found;
}

bool flag(const char* what, py::handle value) {
  const PyNumberMethods* const methods = Py_TYPE(value.ptr())->tp_as_number;
  const int found = methods && methods->nb_bool ? PyObject_IsTrue(value.ptr()) : -1;
  if (found >= 0) return found > 0;
  PyErr_Clear();
  refuse(what, "True or False", value);
}

std::string text(const char* what, py::handle value) {
  if (!PyUnicode_Check(value.ptr())) refuse(what, "a text", value);
  Py_ssize_t size = 0;
  const char* const utf8 = PyUnicode_AsUTF8AndSize(value.ptr(), &size);
  if (!utf8) refuse_raised(what, "a text in Unicode", value);
  std::string found(utf8, static_cast<std::size_t>(size));
  if (found.find('\0') != std::string::npos) refuse(what, "a text without the character 0", value);
  return found;
}

std::string path(const char* what, py::handle value) {
  PyObject* converted = nullptr;
  if (!PyUnicode_FSConverter(value.ptr(), &converted)) refuse_raised(what, "a file", value);
  const auto bytes = py::reinterpret_steal<py::bytes>(converted);
  return std::string(PyBytes_AS_STRING(bytes.ptr()), static_cast<std::size_t>(PyBytes_GET_SIZE(bytes.ptr())));
}

}  // namespace python

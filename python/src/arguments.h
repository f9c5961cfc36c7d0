// Arguments of Python: what does not fit raises Error with one line that names the argument, the value and what was expected. With the GIL.
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <vector>

namespace python {

namespace py = pybind11;

// How a value looks in such a line: its repr(), cut to 60 characters.
std::string shown(py::handle value);

// Finite. Anything with __float__, but no text.
double number(const char* what, py::handle value);
// Not negative; inf is allowed.
std::chrono::duration<double> seconds(const char* what, py::handle value);
// Anything with __index__, or a float without a fraction.
std::int64_t whole(const char* what, py::handle value, std::int64_t lowest = 0,
                   std::int64_t highest = std::numeric_limits<std::int64_t>::max());
std::uint64_t seed(py::handle value);
// One of these counts of numbers; an empty list of counts: any.
std::vector<double> numbers(const char* what, py::handle value, std::initializer_list<std::size_t> counts = {});
// Anything that says whether it is true, but is no text or list.
bool flag(const char* what, py::handle value);
std::string text(const char* what, py::handle value);
// A text, bytes or an os.PathLike.
std::string path(const char* what, py::handle value);

}  // namespace python

// Service ports of components of Python. register*: before the port is used; the rest: any thread with the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

namespace python {

void add_services(pybind11::module_& module);

}  // namespace python

// The manager of this process, for Python. Any thread that has the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

namespace python {

void add_manager(pybind11::module_& module);

}  // namespace python

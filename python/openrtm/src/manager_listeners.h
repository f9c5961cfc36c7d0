// Listeners in Python to what the manager does. Each is a function (name of the event, arguments...), called on the thread of the event
// with the interpreter's lock; what it raises is logged with its traceback. They live as long as the process.
#pragma once

#include <pybind11/pybind11.h>

namespace python {

void add_manager_listeners(pybind11::module_& module);

}  // namespace python

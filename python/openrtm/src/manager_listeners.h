// Listeners in Python to the actions of the manager. Each is a function (name of the event, arguments...), called on the thread of the
// event with the interpreter's lock; an exception is logged with its traceback. They exist until the process ends.
#pragma once

#include <pybind11/pybind11.h>

namespace python {

void add_manager_listeners(pybind11::module_& module);

}  // namespace python

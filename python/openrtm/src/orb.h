// The ORB for Python: references, servants, and values as CDR (packages/omniORB). Any thread that has the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

namespace python {

void add_orb(pybind11::module_& module);

}  // namespace python

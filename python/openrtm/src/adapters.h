// Object adapters (POAs) for Python, and the activation of servants in them. Any thread that has the interpreter's lock.
//
// A servant is active in at most one adapter; its references are those of this adapter. Failure cases: the exceptions that the POA throws
// are raised as those of packages/omniORB/PortableServer.py.
#pragma once

#include <pybind11/pybind11.h>

#include "references.h"

namespace python {

// The Python object behind a reference, when it is in this process; else None.
pybind11::object local_servant(const ObjRef& reference);

void add_adapters(pybind11::module_& module);

}  // namespace python

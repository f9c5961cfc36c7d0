// SDO services of components in Python: providers, which tools find at a component, and consumers of services that tools attach to it.
// They are Python objects with the methods init(component, profile), reinit(profile), getProfile() and finalize(). Failure cases: a method
// that raises is logged with its traceback, and counts as one that returned False.
#pragma once

#include <pybind11/pybind11.h>

#include "component.h"

namespace python {

void add_sdo_of_components(pybind11::class_<Component, std::shared_ptr<Component>>& cls);
void add_sdo(pybind11::module_& module);

}  // namespace python

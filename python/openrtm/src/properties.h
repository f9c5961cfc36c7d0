// coil::Properties as Python sees them: a node, and what keeps its tree alive. One thread at a time, with the interpreter's lock.
#pragma once

#include <coil/Properties.h>
#include <pybind11/pybind11.h>

#include <memory>

namespace python {

struct Properties {
  std::shared_ptr<void> owner;
  coil::Properties* node = nullptr;

  static Properties copy_of(const coil::Properties& other) {
    auto own = std::make_shared<coil::Properties>(other);
    return {own, own.get()};
  }
};

void add_properties(pybind11::module_& module);

}  // namespace python

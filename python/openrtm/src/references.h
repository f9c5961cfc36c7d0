// References to CORBA objects as Python sees them: the attribute _obj of a stub. With the interpreter's lock.
#pragma once

#include <Python.h>
#include <omniORB4/CORBA.h>

#include <optional>

namespace python {

// The attribute _obj of a stub.
struct ObjRef {
  CORBA::Object_var object;
};

// The reference of a stub or of a servant's _this(), nil for None; nothing for any other object.
std::optional<CORBA::Object_var> reference_in(PyObject* stub);
// A stub: of the most derived interface whose stubs are loaded, else of the one with that id. None for nil. A new reference; nullptr with a
// Python exception.
PyObject* reference_out(CORBA::Object_ptr object, const char* id);

}  // namespace python

// Execution contexts written in Python: classes derived from ExecutionContextBase, PeriodicExecutionContext or ExtTrigExecutionContext of
// the package, which a factory makes by name.
//
// States: made (the Python object owns it), created (the factory keeps the Python object), destroyed (again only the Python object owns
// it). Rights: the methods that a class overrides are called with the interpreter's lock, svc() on the context's thread, the others on the
// thread of the event; what they call of the context gives the lock back. Failure cases: a method that raises, or returns no value of its
// kind, is logged with its traceback and counts as RTC_ERROR; an svc() that raises or returns ends the thread of its context, and the log
// line says that its components stand still. They can still be deactivated and reset.
#pragma once

#include <pybind11/pybind11.h>

namespace python {

void add_contexts(pybind11::module_& module);

}  // namespace python

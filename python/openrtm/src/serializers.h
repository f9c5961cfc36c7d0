// Serializers of authors, written in Python: classes with init(properties), isLittleEndian(bool), serialize(value) -> (code, bytes) and
// deserialize(bytes, type) -> (code, value). Registered by OpenRTM_aist.SerializerFactories, which keeps the classes; looked up there by
// the names of connections.
//
// Rights: their methods are called with the interpreter's lock, by one thread at a time each; their names are known without it. Failure
// cases: a method that raises, returns another code than 0, or a value that does not fit the type of the port, makes write() fail or the
// sample be dropped; what was raised is logged with its traceback.
#pragma once

#include <pybind11/pybind11.h>
#include <rtm/Serializers.h>

#include "types.h"

namespace python {

// The serializers of ports of that type; made once, kept for ever. With the interpreter's lock.
const RTC::detail::Serializers& serializers_of(const Type& type);

void add_serializers(pybind11::module_& module);

}  // namespace python

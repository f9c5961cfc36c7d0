// Finds the component or execution context of this process behind an object reference. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <memory>

namespace RTC {

class ExecutionContextBase;
class RTObject_impl;

// Null when the object lives elsewhere, is something else or is gone. The pointer keeps the servant alive, not its place in the object
// adapter.
std::shared_ptr<RTObject_impl> findLocalComponent(CORBA::Object_ptr object);
std::shared_ptr<ExecutionContextBase> findLocalContext(CORBA::Object_ptr object);

}  // namespace RTC

// How long calls to other ports may take. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>

namespace corba {

// The longest that a call to another port, or one sample on its way to one, may take unless the connection says otherwise
// (dataport.call_timeout). Default 10 s, as in OpenRTM 2.x.
void set_port_call_timeout(std::chrono::milliseconds timeout);
std::chrono::milliseconds port_call_timeout();

// Every later call of this reference ends after `timeout`, with CORBA::TIMEOUT or TRANSIENT if the other side hangs. Nil is ignored.
void limit_calls(CORBA::Object_ptr object, std::chrono::milliseconds timeout);

}  // namespace corba

// Names of the owners of objects of this process, for messages about received calls: "component Laser0", "port Arm0:control". Any
// thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <cstddef>
#include <span>
#include <string>

namespace corba {

// The octets by which a call names the object; empty for nil and for references of another protocol.
std::string object_key(CORBA::Object_ptr object);

// "port A:out", as people write it, for the port "A.out".
std::string port_text(std::string name);

// Until forget_object; again for another name.
void name_object(CORBA::Object_ptr object, const std::string& name);
// By the name that `owner` has when somebody asks.
void name_object_as(CORBA::Object_ptr object, CORBA::Object_ptr owner);
void forget_object(CORBA::Object_ptr object);
// "this process" when nobody has named it.
std::string name_of_object(std::span<const std::byte> key);

}  // namespace corba

// Checks type codes, for code that decodes anys itself, such as the Python module. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

// Reads a type code and writes it to another stream, from where omniORB may read it. Unions are allowed; for the rest see any_check.cpp.
// Throws MARSHAL.
void copy_checked_type_code(cdrStream& from, cdrStream& to);

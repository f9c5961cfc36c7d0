// Name-value lists of the wire: making, searching, and to and from coil::Properties. Any thread; the lists themselves are values.
#pragma once

#include <coil/Properties.h>

#include <iosfwd>
#include <string>

#include "rtm/idl/RTCStub.h"
#include "rtm/idl/SDOPackageStub.h"

namespace NVUtil {

SDOPackage::NameValue newNV(const char* name, const char* value);
inline SDOPackage::NameValue newNV(const char* name, char* value) { return newNV(name, static_cast<const char*>(value)); }
inline SDOPackage::NameValue newNV(const char* name, const std::string& value) { return newNV(name, value.c_str()); }
SDOPackage::NameValue newNVAny(const char* name, const CORBA::Any& value);

template <class Value>
SDOPackage::NameValue newNV(const char* name, Value value) {
  SDOPackage::NameValue nv;
  nv.name = CORBA::string_dup(name);
  nv.value <<= value;
  return nv;
}
template <class Value>
SDOPackage::NameValue newNVChar(const char* name, Value value) {
  SDOPackage::NameValue nv;
  nv.name = CORBA::string_dup(name);
  nv.value <<= CORBA::Any::from_char(value);
  return nv;
}

// Every node as a string value, in the order of the tree.
void copyFromProperties(SDOPackage::NVList& list, const coil::Properties& properties);
// String values only; others are left out.
void copyToProperties(coil::Properties& properties, const SDOPackage::NVList& list);
coil::Properties toProperties(const SDOPackage::NVList& list);

// -1 if there is none of that name.
CORBA::Long find_index(const SDOPackage::NVList& list, const char* name);
inline CORBA::Long find_index(const SDOPackage::NVList& list, const std::string& name) { return find_index(list, name.c_str()); }
// Throws the text "Not found" if there is none of that name.
const CORBA::Any& find(const SDOPackage::NVList& list, const char* name);
inline const CORBA::Any& find(const SDOPackage::NVList& list, const std::string& name) { return find(list, name.c_str()); }

bool isString(const SDOPackage::NVList& list, const char* name);
inline bool isString(const SDOPackage::NVList& list, const std::string& name) { return isString(list, name.c_str()); }
// False also if there is none of that name.
bool isStringValue(const SDOPackage::NVList& list, const char* name, const char* value);
// Empty if there is no string of that name.
std::string toString(const SDOPackage::NVList& list, const char* name);
inline std::string toString(const SDOPackage::NVList& list, const std::string& name) { return toString(list, name.c_str()); }
// All of it, one line per entry.
std::string toString(const SDOPackage::NVList& list);

// Replaces the value of that name or adds it.
void setValue(SDOPackage::NVList& list, const char* name, const CORBA::Any& value);
bool setStringValue(SDOPackage::NVList& list, const char* name, const char* value);
// Adds the text to the comma list of that name unless it is in there; makes the entry if there is none.
bool appendStringValue(SDOPackage::NVList& list, const char* name, const char* value);
inline bool appendStringValue(SDOPackage::NVList& list, const std::string& name, const std::string& value) {
  return appendStringValue(list, name.c_str(), value.c_str());
}
void append(SDOPackage::NVList& destination, const SDOPackage::NVList& source);

void dump(const SDOPackage::NVList& list);
std::ostream& dump_to_stream(std::ostream& out, const SDOPackage::NVList& list);

}  // namespace NVUtil

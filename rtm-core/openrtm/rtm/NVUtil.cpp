#include "rtm/NVUtil.h"

#include <iostream>
#include <sstream>

#include "base/text.h"
#include "corba/orb/nv_list.h"
#include "rtm/CORBA_SeqUtil.h"

namespace NVUtil {

SDOPackage::NameValue newNV(const char* name, const char* value) {
  SDOPackage::NameValue nv;
  nv.name = CORBA::string_dup(name);
  nv.value <<= value;
  return nv;
}

SDOPackage::NameValue newNVAny(const char* name, const CORBA::Any& value) {
  SDOPackage::NameValue nv;
  nv.name = CORBA::string_dup(name);
  nv.value = value;
  return nv;
}

void copyFromProperties(SDOPackage::NVList& list, const coil::Properties& properties) {
  const auto names = properties.propertyNames();
  list.length(static_cast<CORBA::ULong>(names.size()));
  for (CORBA::ULong i = 0; i < names.size(); ++i) list[i] = newNV(names[i].c_str(), properties.getProperty(names[i]).c_str());
}

void copyToProperties(coil::Properties& properties, const SDOPackage::NVList& list) {
  for (CORBA::ULong i = 0; i < list.length(); ++i) {
    const char* text = nullptr;
    if (list[i].value >>= text) properties.setProperty(list[i].name.in(), text);
  }
}

coil::Properties toProperties(const SDOPackage::NVList& list) {
  coil::Properties properties;
  copyToProperties(properties, list);
  return properties;
}

CORBA::Long find_index(const SDOPackage::NVList& list, const char* name) {
  return CORBA_SeqUtil::find(list, [&](const SDOPackage::NameValue& nv) { return std::string_view(nv.name.in()) == name; });
}

const CORBA::Any& find(const SDOPackage::NVList& list, const char* name) {
  const CORBA::Long index = find_index(list, name);
  if (index < 0) throw "Not found";  // what the classic function throws
  return list[static_cast<CORBA::ULong>(index)].value;
}

bool isString(const SDOPackage::NVList& list, const char* name) { return corba::find_text(list, name).has_value(); }

bool isStringValue(const SDOPackage::NVList& list, const char* name, const char* value) { return corba::find_text(list, name) == value; }

std::string toString(const SDOPackage::NVList& list, const char* name) { return corba::find_text(list, name).value_or(""); }

std::string toString(const SDOPackage::NVList& list) {
  std::ostringstream out;
  dump_to_stream(out, list);
  return out.str();
}

void setValue(SDOPackage::NVList& list, const char* name, const CORBA::Any& value) { corba::set_value(list, name, value); }

bool setStringValue(SDOPackage::NVList& list, const char* name, const char* value) {
  corba::set_text(list, name, value);
  return true;
}

bool appendStringValue(SDOPackage::NVList& list, const char* name, const char* value) {
  auto parts = base::split_list(toString(list, name));
  for (const auto& part : parts) {
    if (part == base::trim(value)) return true;
  }
  parts.emplace_back(base::trim(value));
  return setStringValue(list, name, base::join(parts, ",").c_str());
}

void append(SDOPackage::NVList& destination, const SDOPackage::NVList& source) { CORBA_SeqUtil::push_back_list(destination, source); }

std::ostream& dump_to_stream(std::ostream& out, const SDOPackage::NVList& list) {
  for (CORBA::ULong i = 0; i < list.length(); ++i) {
    const char* text = nullptr;
    out << list[i].name.in() << ": " << ((list[i].value >>= text) ? text : "(not a string)") << '\n';
  }
  return out;
}

void dump(const SDOPackage::NVList& list) { dump_to_stream(std::cout, list); }

}  // namespace NVUtil

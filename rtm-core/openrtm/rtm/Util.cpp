#include "rtm/Util.h"

namespace RTC {

SDOPackage::StringList toStringList(const coil::vstring& list) {
  SDOPackage::StringList result;
  result.length(static_cast<CORBA::ULong>(list.size()));
  for (CORBA::ULong i = 0; i < result.length(); ++i) result[i] = list[i].c_str();
  return result;
}

coil::vstring toVector(const SDOPackage::StringList& list) {
  coil::vstring result;
  for (CORBA::ULong i = 0; i < list.length(); ++i) result.emplace_back(list[i].in());
  return result;
}

}  // namespace RTC

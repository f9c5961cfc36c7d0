// The repository id of a data type or of an interface. Any thread.
#pragma once

#include "corba/type_ops.h"

// "IDL:RTC/TimedLong:1.0", "IDL:OpenRTM/Logger:1.0".
template <class DataType>
const char* toTypename() {
  if constexpr (requires { DataType::_PD_repoId; })
    return DataType::_PD_repoId;
  else
    return corba::type_ops<DataType>().type_id.c_str();
}

template <class DataType>
const char* toRepositoryIdOfStruct() {
  return toTypename<DataType>();
}

namespace CORBA_Util {

template <class DataType>
const char* toTypename() {
  return ::toTypename<DataType>();
}
template <class DataType>
const char* toRepositoryId() {
  return ::toTypename<DataType>();
}
template <class DataType>
const char* toRepositoryIdOfStruct() {
  return ::toTypename<DataType>();
}
template <class DataType>
const char* toRepositoryIdOfObject() {
  return ::toTypename<DataType>();
}

}  // namespace CORBA_Util

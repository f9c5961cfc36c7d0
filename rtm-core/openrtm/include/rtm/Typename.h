// The repository id of a data type or of an interface. Any thread.
#pragma once

#include <type_traits>

#include "rtm/DataType.h"

namespace RTC {
namespace detail {

template <class T, class = void>
struct IsInterface : std::false_type {};
template <class T>
struct IsInterface<T, std::void_t<decltype(T::_PD_repoId)>> : std::true_type {};

}  // namespace detail
}  // namespace RTC

// "IDL:RTC/TimedLong:1.0", "IDL:OpenRTM/Logger:1.0".
template <class DataType>
const char* toTypename() {
  if constexpr (RTC::detail::IsInterface<DataType>::value)
    return DataType::_PD_repoId;
  else
    return RTC::detail::data_type<DataType>().id();
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

// The outcome of reading or writing a data port, usable both as the 2.x type and through the 1.x DataPortStatus::Enum.
// A value; any thread.
#pragma once

#include <iosfwd>
#include <vector>

namespace RTC {

class DataPortStatus {
 public:
  enum Enum {
    PORT_OK = 0,
    PORT_ERROR,
    BUFFER_ERROR,
    BUFFER_FULL,
    BUFFER_EMPTY,
    BUFFER_TIMEOUT,
    SEND_FULL,
    SEND_TIMEOUT,
    RECV_EMPTY,
    RECV_TIMEOUT,
    INVALID_ARGS,
    PRECONDITION_NOT_MET,
    CONNECTION_LOST,
    UNKNOWN_ERROR
  };
  constexpr DataPortStatus(Enum value = PORT_OK) : value_(value) {}
  constexpr operator Enum() const { return value_; }
  // "PORT_OK", ...; "UNKNOWN_ERROR" for anything else.
  static const char* toString(DataPortStatus status);

 private:
  Enum value_;
};

inline const char* toString(DataPortStatus status) { return DataPortStatus::toString(status); }
std::ostream& operator<<(std::ostream& out, DataPortStatus status);

using DataPortStatusList = std::vector<DataPortStatus>;

}  // namespace RTC

// For classes written against 1.x that name the outcomes without a scope; it is written with or without a semicolon after it.
#define DATAPORTSTATUS_ENUM                                                                                    \
  typedef ::RTC::DataPortStatus::Enum ReturnCode;                                                              \
  static const ::RTC::DataPortStatus::Enum PORT_OK = ::RTC::DataPortStatus::PORT_OK;                           \
  static const ::RTC::DataPortStatus::Enum PORT_ERROR = ::RTC::DataPortStatus::PORT_ERROR;                     \
  static const ::RTC::DataPortStatus::Enum BUFFER_ERROR = ::RTC::DataPortStatus::BUFFER_ERROR;                 \
  static const ::RTC::DataPortStatus::Enum BUFFER_FULL = ::RTC::DataPortStatus::BUFFER_FULL;                   \
  static const ::RTC::DataPortStatus::Enum BUFFER_EMPTY = ::RTC::DataPortStatus::BUFFER_EMPTY;                 \
  static const ::RTC::DataPortStatus::Enum BUFFER_TIMEOUT = ::RTC::DataPortStatus::BUFFER_TIMEOUT;             \
  static const ::RTC::DataPortStatus::Enum SEND_FULL = ::RTC::DataPortStatus::SEND_FULL;                       \
  static const ::RTC::DataPortStatus::Enum SEND_TIMEOUT = ::RTC::DataPortStatus::SEND_TIMEOUT;                 \
  static const ::RTC::DataPortStatus::Enum RECV_EMPTY = ::RTC::DataPortStatus::RECV_EMPTY;                     \
  static const ::RTC::DataPortStatus::Enum RECV_TIMEOUT = ::RTC::DataPortStatus::RECV_TIMEOUT;                 \
  static const ::RTC::DataPortStatus::Enum INVALID_ARGS = ::RTC::DataPortStatus::INVALID_ARGS;                 \
  static const ::RTC::DataPortStatus::Enum PRECONDITION_NOT_MET = ::RTC::DataPortStatus::PRECONDITION_NOT_MET; \
  static const ::RTC::DataPortStatus::Enum CONNECTION_LOST = ::RTC::DataPortStatus::CONNECTION_LOST;           \
  static const ::RTC::DataPortStatus::Enum UNKNOWN_ERROR = ::RTC::DataPortStatus::UNKNOWN_ERROR;

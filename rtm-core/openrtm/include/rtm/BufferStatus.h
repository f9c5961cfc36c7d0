// Result of a call of a buffer. Values.
#pragma once

namespace RTC {

struct BufferStatus {
  enum Enum { BUFFER_OK = 0, BUFFER_ERROR, BUFFER_FULL, BUFFER_EMPTY, NOT_SUPPORTED, TIMEOUT, PRECONDITION_NOT_MET };
  // The names of 2.x.
  static constexpr Enum OK = BUFFER_OK;
  static constexpr Enum FULL = BUFFER_FULL;
  static constexpr Enum EMPTY = BUFFER_EMPTY;

  constexpr BufferStatus(Enum value = BUFFER_OK) : value_(value) {}
  constexpr operator Enum() const { return value_; }

  static constexpr const char* toString(Enum status) {
    constexpr const char* names[] = {"BUFFER_OK",     "BUFFER_ERROR", "BUFFER_FULL",         "BUFFER_EMPTY",
                                     "NOT_SUPPORTED", "TIMEOUT",      "PRECONDITION_NOT_MET"};
    return status >= BUFFER_OK && status <= PRECONDITION_NOT_MET ? names[status] : "UNKNOWN";
  }

 private:
  Enum value_;
};

}  // namespace RTC

// The names for a class that answers with them.
#define BUFFERSTATUS_ENUM                                                         \
  typedef ::RTC::BufferStatus::Enum ReturnCode;                                   \
  static constexpr ReturnCode BUFFER_OK = ::RTC::BufferStatus::BUFFER_OK;         \
  static constexpr ReturnCode BUFFER_ERROR = ::RTC::BufferStatus::BUFFER_ERROR;   \
  static constexpr ReturnCode BUFFER_FULL = ::RTC::BufferStatus::BUFFER_FULL;     \
  static constexpr ReturnCode BUFFER_EMPTY = ::RTC::BufferStatus::BUFFER_EMPTY;   \
  static constexpr ReturnCode NOT_SUPPORTED = ::RTC::BufferStatus::NOT_SUPPORTED; \
  static constexpr ReturnCode TIMEOUT = ::RTC::BufferStatus::TIMEOUT;             \
  static constexpr ReturnCode PRECONDITION_NOT_MET = ::RTC::BufferStatus::PRECONDITION_NOT_MET;

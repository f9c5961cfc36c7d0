// Callbacks that a component may hang on its ports. Called on the thread that connects, writes or reads.
#pragma once

#include "rtm/idl/RTCStub.h"

namespace RTC {

class ConnectionCallback {
 public:
  virtual ~ConnectionCallback() = default;
  virtual void operator()(RTC::ConnectorProfile& profile) = 0;
};

class DisconnectCallback {
 public:
  virtual ~DisconnectCallback() = default;
  virtual void operator()(const char* connector_id) = 0;
};

// Before a value is written.
template <class DataType>
class OnWrite {
 public:
  virtual ~OnWrite() = default;
  virtual void operator()(const DataType& value) = 0;
};

template <class DataType>
class OnPush {
 public:
  virtual ~OnPush() = default;
  virtual void operator()(const DataType& value) = 0;
};

// What is written instead of the value.
template <class DataType>
class OnWriteConvert {
 public:
  virtual ~OnWriteConvert() = default;
  virtual DataType operator()(const DataType& value) = 0;
};

// Before a value is read.
template <class DataType>
class OnRead {
 public:
  virtual ~OnRead() = default;
  virtual void operator()() = 0;
};

// What is handed to the component instead of the value.
template <class DataType>
class OnReadConvert {
 public:
  virtual ~OnReadConvert() = default;
  virtual DataType operator()(const DataType& value) = 0;
};

template <class DataType>
class OnOverflow {
 public:
  virtual ~OnOverflow() = default;
  virtual void operator()(const DataType& value) = 0;
};

template <class DataType>
class OnUnderflow {
 public:
  virtual ~OnUnderflow() = default;
  virtual void operator()() = 0;
};

template <class DataType>
class OnWriteTimeout {
 public:
  virtual ~OnWriteTimeout() = default;
  virtual void operator()(const DataType& value) = 0;
};

template <class DataType>
class OnReadTimeout {
 public:
  virtual ~OnReadTimeout() = default;
  virtual DataType operator()() = 0;
};

}  // namespace RTC

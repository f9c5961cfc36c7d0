// A port that sends values of one type. Any thread.
#pragma once

#include <coil/OS.h>
#include <coil/TimeMeasure.h>

#include "rtm/OutPortBase.h"
#include "rtm/PortCallback.h"
#include "rtm/Serializers.h"
#include "rtm/Timestamp.h"
#include "rtm/Typename.h"

namespace RTC {

template <class DataType>
class OutPort : public OutPortBase {
 public:
  using value_type = DataType;

  // The variable must outlive the port. The other arguments of old are taken and mean nothing: connections bring their own buffers.
  OutPort(const char* name, DataType& value, int = 8, bool = false, bool = false, int = 0, int = 0)
      : OutPortBase(name, detail::data_type<DataType>(), detail::serializers_of<DataType>()), value_(value) {}
  ~OutPort() override { retire(); }

  bool write() override { return write(value_); }
  virtual bool write(DataType& value) {
    if (on_write_) (*on_write_)(value);
    if (!on_write_convert_) return writeValue(&value);
    const DataType converted = (*on_write_convert_)(value);
    return writeValue(&converted);
  }
  bool operator<<(DataType& value) { return write(value); }

  // Not owned; nullptr removes one.
  void setOnWrite(OnWrite<DataType>* callback) { on_write_ = callback; }
  void setOnWriteConvert(OnWriteConvert<DataType>* callback) { on_write_convert_ = callback; }

 private:
  DataType& value_;
  OnWrite<DataType>* on_write_ = nullptr;
  OnWriteConvert<DataType>* on_write_convert_ = nullptr;
};

}  // namespace RTC

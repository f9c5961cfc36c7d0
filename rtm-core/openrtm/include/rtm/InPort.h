// A port that receives values of one type into a variable of the component. One thread at a time reads.
#pragma once

#include <coil/OS.h>
#include <coil/TimeMeasure.h>

#include <string>

#include "rtm/InPortBase.h"
#include "rtm/PortCallback.h"
#include "rtm/Serializers.h"
#include "rtm/Timestamp.h"
#include "rtm/Typename.h"

namespace RTC {

template <class DataType>
class InPort : public InPortBase {
 public:
  using value_type = DataType;

  // The variable must outlive the port. The other arguments of old are taken and mean nothing: connections bring their own buffers.
  InPort(const char* name, DataType& value, int = 64, bool = false, bool = false, int = 0, int = 0)
      : InPortBase(name, detail::data_type<DataType>(), detail::serializers_of<DataType>()), value_(value) {}
  ~InPort() override { retire(); }

  bool read(std::string name = "") override {
    if (on_read_) (*on_read_)();
    if (!readValue(name, &value_)) return false;
    if (on_read_convert_) value_ = (*on_read_convert_)(value_);
    return true;
  }
  virtual void update() { read(); }
  bool operator>>(DataType& value) {
    const bool is_read = read();
    value = value_;
    return is_read;
  }

  // Not owned; nullptr removes one.
  void setOnRead(OnRead<DataType>* callback) { on_read_ = callback; }
  void setOnReadConvert(OnReadConvert<DataType>* callback) { on_read_convert_ = callback; }

 private:
  DataType& value_;
  OnRead<DataType>* on_read_ = nullptr;
  OnReadConvert<DataType>* on_read_convert_ = nullptr;
};

}  // namespace RTC

// See coil/Properties.h.
#pragma once

#include <rtm/idl/RTCSkel.h>

namespace RTC {

class PortBase {
 public:
  explicit PortBase(const char* name = "");
  virtual ~PortBase();
  const char* getName() const;
  PortService_ptr getPortRef();
};

// The data type's conversion to CORBA::Any is looked for here, by ordinary lookup: its header must have come before.
template <class DataType>
void type_name() {
  CORBA::Any any;
  const DataType value{};
  any <<= value;
}

}  // namespace RTC

template <class DataType>
void setTimestamp(DataType& data) {
  data.tm.sec = 0;
}

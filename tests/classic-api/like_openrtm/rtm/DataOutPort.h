// See coil/Properties.h.
#pragma once

#include <rtm/PortBase.h>

namespace RTC {

class OutPortBase : public PortBase {
 public:
  using PortBase::PortBase;
};

template <class DataType>
class OutPort : public OutPortBase {
 public:
  OutPort(const char* name, DataType&) : OutPortBase(name) { type_name<DataType>(); }
  bool write();
  bool write(DataType& value);
};

}  // namespace RTC

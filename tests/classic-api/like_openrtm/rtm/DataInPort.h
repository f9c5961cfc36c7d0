// See coil/Properties.h.
#pragma once

#include <rtm/PortBase.h>

#include <string>

namespace RTC {

class InPortBase : public PortBase {
 public:
  using PortBase::PortBase;
};

template <class DataType>
class InPort : public InPortBase {
 public:
  InPort(const char* name, DataType&) : InPortBase(name) { type_name<DataType>(); }
  bool isNew();
  bool isEmpty();
  bool read(std::string name = "");
};

}  // namespace RTC

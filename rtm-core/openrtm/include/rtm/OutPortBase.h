// All of an OutPort that does not depend on its type. Any thread; samples written by one thread keep their order.
#pragma once

#include "rtm/DataPortBase.h"

namespace RTC {

class OutPortBase : public DataPortBase<OutPortConnector> {
 public:
  OutPortBase(const char* name, const detail::DataType& type, const detail::Serializers& serializers);
  ~OutPortBase() override;

  // Writes the bound variable; false if there is no connection or one failed; the statuses tell which.
  virtual bool write() = 0;

 protected:
  // Returns when no other thread is in the port any more. The destructor of the last class in line calls it first.
  void retire();
  bool writeValue(const void* value);

  ReturnCode_t prepare(ConnectorProfile& profile, const detail::PortTerms& terms) override;
};

}  // namespace RTC

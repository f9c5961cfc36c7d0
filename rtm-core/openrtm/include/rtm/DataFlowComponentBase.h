// The base class of components.
#pragma once

#include <rtm/RTObject.h>

namespace RTC {

class DataFlowComponentBase : public RTObject_impl {
 public:
  explicit DataFlowComponentBase(Manager* manager);
  DataFlowComponentBase(CORBA::ORB_ptr orb, PortableServer::POA_ptr poa);
  ~DataFlowComponentBase() override;
};

}  // namespace RTC

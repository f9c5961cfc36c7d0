// The base class of components.
#pragma once

#include <rtm/Manager.h>
#include <rtm/PeriodicExecutionContext.h>
#include <rtm/PortBase.h>
#include <rtm/RTObject.h>
#include <rtm/idl/RTCSkel.h>

namespace RTC {

class DataFlowComponentBase : public RTObject_impl {
 public:
  explicit DataFlowComponentBase(Manager* manager);
  DataFlowComponentBase(CORBA::ORB_ptr orb, PortableServer::POA_ptr poa);
  ~DataFlowComponentBase() override;
};

}  // namespace RTC

// The operations of RTC::ExecutionContextService (Skeleton is its skeleton or that of an interface derived from it) answered by
// ExecutionContextBase. Any thread.
#pragma once

#include <rtm/ExecutionContextBase.h>

namespace RTC {

template <class Skeleton>
class ExecutionContextServant : public virtual Skeleton, public virtual PortableServer::RefCountServantBase, public ExecutionContextBase {
 public:
  using ExecutionContextBase::ExecutionContextBase;

  CORBA::Boolean is_running() override { return isRunning(); }
  RTC::ReturnCode_t start() override { return ExecutionContextBase::start(); }
  RTC::ReturnCode_t stop() override { return ExecutionContextBase::stop(); }
  CORBA::Double get_rate() override { return getRate(); }
  RTC::ReturnCode_t set_rate(CORBA::Double rate) override { return setRate(rate); }
  RTC::ReturnCode_t add_component(RTC::LightweightRTObject_ptr comp) override { return addComponent(comp); }
  RTC::ReturnCode_t remove_component(RTC::LightweightRTObject_ptr comp) override { return removeComponent(comp); }
  RTC::ReturnCode_t activate_component(RTC::LightweightRTObject_ptr comp) override { return activateComponent(comp); }
  RTC::ReturnCode_t deactivate_component(RTC::LightweightRTObject_ptr comp) override { return deactivateComponent(comp); }
  RTC::ReturnCode_t reset_component(RTC::LightweightRTObject_ptr comp) override { return resetComponent(comp); }
  RTC::LifeCycleState get_component_state(RTC::LightweightRTObject_ptr comp) override { return getComponentState(comp); }
  RTC::ExecutionKind get_kind() override { return getKind(); }
  RTC::ExecutionContextProfile* get_profile() override { return getProfile(); }
};

}  // namespace RTC

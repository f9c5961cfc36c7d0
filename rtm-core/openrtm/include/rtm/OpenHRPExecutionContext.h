// Runs one cycle inside each tick(), on the caller's thread; concurrent callers take turns. Components change their state without a tick,
// on the thread of the one who asks for it.
#pragma once

#include <rtm/ExecutionContextServant.h>
#include <rtm/idl/OpenRTMSkel.h>

#include <memory>

namespace RTC {

class Manager;

class OpenHRPExecutionContext : public ExecutionContextServant<POA_OpenRTM::ExtTrigExecutionContextService> {
 public:
  explicit OpenHRPExecutionContext(const std::string& name = "exttrig_sync_ec");
  ~OpenHRPExecutionContext() override;

  // Returns after the cycle. A tick from inside a cycle does nothing.
  void tick() override;

 protected:
  RTC::ReturnCode_t onWaitingActivated(RTC_impl::RTObjectStateMachine* comp, long int count) override;
  RTC::ReturnCode_t onWaitingDeactivated(RTC_impl::RTObjectStateMachine* comp, long int count) override;
  RTC::ReturnCode_t onWaitingReset(RTC_impl::RTObjectStateMachine* comp, long int count) override;
  // Does the transitions that are asked for, on this thread, unless a cycle runs and will do them.
  void transitNow();
  // For contexts of authors: each takes its turn; from inside a cycle it does nothing.
  void invokeWorker();
  void invokeWorkerPreDo();
  void invokeWorkerDo();
  void invokeWorkerPostDo();

 private:
  class Turns;
  std::unique_ptr<Turns> turns_;
};

}  // namespace RTC

extern "C" void OpenHRPExecutionContextInit(RTC::Manager* manager);

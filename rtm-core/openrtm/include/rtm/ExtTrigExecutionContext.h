// Runs one cycle per tick(), on a thread of its own. Every tick is a cycle, also those that come while one runs. Components change their
// state without a tick.
#pragma once

#include <coil/Task.h>
#include <rtm/ExecutionContextServant.h>
#include <rtm/idl/OpenRTMSkel.h>

#include <memory>

namespace RTC {

class Manager;

class ExtTrigExecutionContext : public ExecutionContextServant<POA_OpenRTM::ExtTrigExecutionContextService>, public coil::Task {
 public:
  ExtTrigExecutionContext();
  ~ExtTrigExecutionContext() override;

  // Returns at once. Ticks of a stopped context are forgotten.
  void tick() override;

  int open(void* args) override;
  int svc() override;
  int close(unsigned long flags) override;

  // Both bases have operations of these names; components call the context's.
  RTC::ReturnCode_t start() override { return ExecutionContextBase::start(); }
  RTC::ReturnCode_t stop() override { return ExecutionContextBase::stop(); }

 protected:
  RTC::ReturnCode_t onStarted() override;
  RTC::ReturnCode_t onStopping() override;
  void onWakeUp() override;

 private:
  class Steps;
  std::unique_ptr<Steps> steps_;
  class Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace RTC

extern "C" void ExtTrigExecutionContextInit(RTC::Manager* manager);

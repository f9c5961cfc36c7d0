#include "rtm/ExtTrigExecutionContext.h"

#include <rtm/ECFactory.h>

#include "component/runtime_access.h"
#include "core/workers.h"

namespace RTC {

class ExtTrigExecutionContext::Steps final : public rt::Steps {
 public:
  explicit Steps(ExtTrigExecutionContext& context) : context_(context) {}
  void transit() override { context_.invokeWorkerPreDo(); }
  void execute_and_update() override {
    context_.invokeWorkerDo();
    context_.invokeWorkerPostDo();
  }

 private:
  ExtTrigExecutionContext& context_;
};

class ExtTrigExecutionContext::Worker final : public rt::TriggeredWorker {
 public:
  using rt::TriggeredWorker::TriggeredWorker;
};

ExtTrigExecutionContext::ExtTrigExecutionContext()
    : ExecutionContextServant("exttrig_async_ec"),
      steps_(std::make_unique<Steps>(*this)),
      worker_(std::make_unique<Worker>(RuntimeAccess::context(*this), *steps_)) {
  keepThread();  // what components keep for their thread outlasts stop() and start()
  setObjRef(RTC::ExecutionContextService_var(_this()));
  setKind(RTC::PERIODIC);
}

ExtTrigExecutionContext::~ExtTrigExecutionContext() {
  worker_->stop();
  coil::Task::wait();
}

void ExtTrigExecutionContext::tick() { worker_->tick(); }

RTC::ReturnCode_t ExtTrigExecutionContext::onStarted() {
  coil::Task::wait();
  worker_->reset();
  open(nullptr);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t ExtTrigExecutionContext::onStopping() {
  worker_->stop();
  if (!waitForCallbacks() && worker_->resume()) return RTC::RTC_ERROR;
  coil::Task::wait();
  return RTC::RTC_OK;
}

void ExtTrigExecutionContext::onWakeUp() { worker_->wake(); }

int ExtTrigExecutionContext::open(void*) {
  coil::Task::activate();
  return 0;
}

int ExtTrigExecutionContext::svc() {
  worker_->run();
  return 0;
}

int ExtTrigExecutionContext::close(unsigned long) { return 0; }

}  // namespace RTC

extern "C" void ExtTrigExecutionContextInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("ExtTrigExecutionContext", RTC::ECCreate<RTC::ExtTrigExecutionContext>,
                                                      RTC::ECDelete<RTC::ExtTrigExecutionContext>);
}

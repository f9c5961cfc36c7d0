#include <rtm/ECFactory.h>
#include <rtm/OpenHRPExecutionContext.h>

#include "core/workers.h"

namespace RTC {

OpenHRPExecutionContext::OpenHRPExecutionContext(const std::string& name)
    : ExecutionContextServant(name), turns_(std::make_unique<rt::Turns>()) {
  setObjRef(RTC::ExecutionContextService_var(_this()));
  setKind(RTC::PERIODIC);
}

OpenHRPExecutionContext::~OpenHRPExecutionContext() = default;

void OpenHRPExecutionContext::tick() {
  turns_->take([this] { invokeWorker(); });
}

void OpenHRPExecutionContext::transitNow() {
  turns_->take([this] { invokeWorkerPreDo(); });
}

RTC::ReturnCode_t OpenHRPExecutionContext::onWaitingActivated(RTC_impl::RTObjectStateMachine*, long int) {
  transitNow();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t OpenHRPExecutionContext::onWaitingDeactivated(RTC_impl::RTObjectStateMachine*, long int) {
  transitNow();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t OpenHRPExecutionContext::onWaitingReset(RTC_impl::RTObjectStateMachine*, long int) {
  transitNow();
  return RTC::RTC_OK;
}

}  // namespace RTC

extern "C" void OpenHRPExecutionContextInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("OpenHRPExecutionContext", RTC::ECCreate<RTC::OpenHRPExecutionContext>,
                                                      RTC::ECDelete<RTC::OpenHRPExecutionContext>);
}

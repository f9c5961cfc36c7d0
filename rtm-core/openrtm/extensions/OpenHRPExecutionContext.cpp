#include "rtm/OpenHRPExecutionContext.h"

#include <rtm/ECFactory.h>

#include "core/workers.h"

namespace RTC {

class OpenHRPExecutionContext::Turns final : public rt::CallSerializer {};

OpenHRPExecutionContext::OpenHRPExecutionContext(const std::string& name)
    : ExecutionContextServant(name), turns_(std::make_unique<Turns>()) {
  setObjRef(RTC::ExecutionContextService_var(_this()));
  setKind(RTC::PERIODIC);
}

OpenHRPExecutionContext::~OpenHRPExecutionContext() = default;

void OpenHRPExecutionContext::tick() { OpenHRPExecutionContext::invokeWorker(); }

void OpenHRPExecutionContext::transitNow() { OpenHRPExecutionContext::invokeWorkerPreDo(); }

void OpenHRPExecutionContext::invokeWorker() {
  turns_->take([this] { ExecutionContextBase::invokeWorker(); });
}

void OpenHRPExecutionContext::invokeWorkerPreDo() {
  turns_->take([this] { ExecutionContextBase::invokeWorkerPreDo(); });
}

void OpenHRPExecutionContext::invokeWorkerDo() {
  turns_->take([this] { ExecutionContextBase::invokeWorkerDo(); });
}

void OpenHRPExecutionContext::invokeWorkerPostDo() {
  turns_->take([this] { ExecutionContextBase::invokeWorkerPostDo(); });
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
  // The first name is that of all versions.
  for (const char* name : {"SynchExtTriggerEC", "OpenHRPExecutionContext"})
    RTC::ExecutionContextFactory::instance().addFactory(name, RTC::ECCreate<RTC::OpenHRPExecutionContext>,
                                                        RTC::ECDelete<RTC::OpenHRPExecutionContext>);
}

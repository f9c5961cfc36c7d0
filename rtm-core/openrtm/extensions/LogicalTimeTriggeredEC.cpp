#include "rtm/LogicalTimeTriggeredEC.h"

#include <rtm/ECFactory.h>

#include "base/clock.h"
#include "component/runtime_access.h"
#include "core/workers.h"

namespace RTC {

struct LogicalTimeTriggeredEC::Time {
  base::ManualClock clock;
};

class LogicalTimeTriggeredEC::Steps final : public rt::Steps {
 public:
  explicit Steps(LogicalTimeTriggeredEC& context) : context_(context) {}
  void begin_tick(std::chrono::nanoseconds time) override { context_.clock_->clock.set(time); }
  void transit() override { context_.invokeWorkerPreDo(); }
  void execute_and_update() override {
    context_.invokeWorkerDo();
    context_.invokeWorkerPostDo();
  }

 private:
  LogicalTimeTriggeredEC& context_;
};

class LogicalTimeTriggeredEC::Worker final : public rt::TriggeredWorker {
 public:
  using rt::TriggeredWorker::TriggeredWorker;
};

LogicalTimeTriggeredEC::LogicalTimeTriggeredEC()
    : ExecutionContextServant("logicaltime_ec"),
      clock_(std::make_shared<Time>()),
      steps_(std::make_unique<Steps>(*this)),
      worker_(std::make_unique<Worker>(RuntimeAccess::context(*this), *steps_)) {
  keepThread();  // what components keep for their thread outlasts stop() and start()
  setObjRef(RTC::ExecutionContextService_var(_this()));
  setKind(RTC::PERIODIC);
}

LogicalTimeTriggeredEC::~LogicalTimeTriggeredEC() {
  worker_->stop();
  coil::Task::wait();
}

void LogicalTimeTriggeredEC::tick(CORBA::ULong sec, CORBA::ULong usec) {
  worker_->tick_and_wait(std::chrono::seconds(sec) + std::chrono::microseconds(usec));
}

void LogicalTimeTriggeredEC::get_time(CORBA::ULong& sec, CORBA::ULong& usec) {
  const auto now = std::chrono::duration_cast<std::chrono::microseconds>(clock_->clock.now());
  sec = static_cast<CORBA::ULong>(now / std::chrono::seconds(1));
  usec = static_cast<CORBA::ULong>((now % std::chrono::seconds(1)).count());
}

const base::Clock& LogicalTimeTriggeredEC::contextClock() const { return clock_->clock; }
std::shared_ptr<const base::Clock> LogicalTimeTriggeredEC::sharedClock() const { return {clock_, &clock_->clock}; }

RTC::ReturnCode_t LogicalTimeTriggeredEC::onStarted() {
  coil::Task::wait();
  worker_->reset();
  open(nullptr);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t LogicalTimeTriggeredEC::onStopping() {
  worker_->stop();
  if (!waitForCallbacks() && worker_->resume()) return RTC::RTC_ERROR;
  coil::Task::wait();
  return RTC::RTC_OK;
}

void LogicalTimeTriggeredEC::onWakeUp() { worker_->wake(); }

int LogicalTimeTriggeredEC::open(void*) {
  coil::Task::activate();
  return 0;
}

int LogicalTimeTriggeredEC::svc() {
  worker_->run();
  return 0;
}

int LogicalTimeTriggeredEC::close(unsigned long) { return 0; }

}  // namespace RTC

extern "C" void LogicalTimeTriggeredECInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("LogicalTimeTriggeredEC", RTC::ECCreate<RTC::LogicalTimeTriggeredEC>,
                                                      RTC::ECDelete<RTC::LogicalTimeTriggeredEC>);
}

#include "rtm/PeriodicExecutionContext.h"

#include <rtm/ECFactory.h>

#include <pthread.h>

#include <thread>

#include "base/text.h"
#include "component/runtime_access.h"
#include "core/connector_settings.h"
#include "core/workers.h"

namespace RTC {

namespace {

constexpr std::size_t largest_stack = std::size_t{256} << 20;  // [octets]

}  // namespace

class PeriodicExecutionContext::Steps final : public rt::Steps {
 public:
  explicit Steps(PeriodicExecutionContext& context) : context_(context) {}
  void transit() override { context_.stepTransitions(); }
  void execute_and_update() override { context_.stepExecution(); }

 private:
  PeriodicExecutionContext& context_;
};

class PeriodicExecutionContext::Worker final : public rt::PeriodicWorker {
 public:
  using rt::PeriodicWorker::PeriodicWorker;
};

PeriodicExecutionContext::PeriodicExecutionContext(const std::string& name)
    : ExecutionContextServant(name),
      steps_(std::make_unique<Steps>(*this)),
      worker_(std::make_unique<Worker>(RuntimeAccess::context(*this), *steps_)) {
  keepThread();  // what components keep for their thread outlasts stop() and start()
  setObjRef(RTC::ExecutionContextService_var(_this()));
  setKind(RTC::PERIODIC);
  m_period = getPeriod();
}

PeriodicExecutionContext::~PeriodicExecutionContext() { endThread(); }

void PeriodicExecutionContext::endThread() {
  m_svc = false;
  RuntimeAccess::context(*this).halt();  // loops of authors ask isRunning()
  worker_->stop();
  wakeLoop();
  coil::Task::wait();
  RuntimeAccess::context(*this).resume();  // for the next thread
}

RTC::ReturnCode_t PeriodicExecutionContext::onSetRate(double) {
  m_period = getPeriod();
  return RTC::RTC_OK;
}

void PeriodicExecutionContext::init(coil::Properties& props) {
  ExecutionContextBase::init(props);
  processors_.clear();
  for (const std::string& part : base::split_list(props.getProperty("cpu_affinity"))) {
    const auto number = base::parse_integer(part);
    if (number && *number >= 0 && *number < CPU_SETSIZE)
      processors_.push_back(static_cast<unsigned>(*number));
    else
      RTC_WARN(("cpu_affinity must be a list of processor numbers, got %s", base::in_quotes(part).c_str()));
  }
  priority_ = 0;
  if (const auto number = base::parse_integer(props.getProperty("priority")); number && *number >= 1 && *number <= 99)
    priority_ = static_cast<int>(*number);
  const std::string stack = props.getProperty("stack_size");
  const auto octets = stack.empty() ? std::size_t{0} : rt::parse_size(stack);
  if (!octets || *octets > largest_stack || !setStackSize(*octets))
    RTC_WARN(("stack_size must be a size from 16k to 256M, like 256k or 8M, got %s", base::in_quotes(stack).c_str()));
}

RTC::ReturnCode_t PeriodicExecutionContext::onStarted() {
  if (!isSteppingThread()) coil::Task::wait();  // a callback that has stopped its context starts it again: the thread goes on
  worker_->reset();
  m_svc = true;
  open(nullptr);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t PeriodicExecutionContext::onStopping() {
  m_svc = false;
  worker_->stop();
  onWakeUp();  // also of derived classes, whose thread may wait for something else; from here on threadRunning() is false
  if (isSteppingThread()) return RTC::RTC_OK;  // the thread ends after this cycle
  if (!waitForCallbacks() && worker_->resume()) {
    m_svc = true;
    return RTC::RTC_ERROR;
  }
  coil::Task::wait();
  return RTC::RTC_OK;
}

void PeriodicExecutionContext::onWakeUp() {
  worker_->wake();
  wakeLoop();
}

void PeriodicExecutionContext::wakeLoop() {
  m_worker.wake();
  m_workerthread.wake();
}

bool PeriodicExecutionContext::threadRunning() const { return !worker_->is_stopping(); }

int PeriodicExecutionContext::open(void*) {
  coil::Task::activate();
  return 0;
}

int PeriodicExecutionContext::svc() {
  if (!processors_.empty()) {
    cpu_set_t set;
    CPU_ZERO(&set);
    for (const unsigned processor : processors_) CPU_SET(processor, &set);
    if (pthread_setaffinity_np(pthread_self(), sizeof set, &set) != 0) RTC_WARN(("cpu_affinity names no processor of this machine"));
  }
  if (priority_ > 0) {
    sched_param parameters{};
    parameters.sched_priority = priority_;
    if (pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) != 0) RTC_WARN(("no right to the real-time priority %d", priority_));
  }
  worker_->run();
  return 0;
}

int PeriodicExecutionContext::close(unsigned long) { return 0; }

}  // namespace RTC

extern "C" void PeriodicExecutionContextInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("PeriodicExecutionContext", RTC::ECCreate<RTC::PeriodicExecutionContext>,
                                                      RTC::ECDelete<RTC::PeriodicExecutionContext>);
}

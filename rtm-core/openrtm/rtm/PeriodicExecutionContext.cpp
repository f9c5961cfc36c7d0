#include "rtm/PeriodicExecutionContext.h"

#include <rtm/ECFactory.h>

#include <pthread.h>

#include <thread>

#include "base/text.h"
#include "component/runtime_access.h"
#include "core/connector_settings.h"

namespace RTC {

namespace {

constexpr std::size_t largest_stack = std::size_t{256} << 20;  // [octets]

}  // namespace

PeriodicExecutionContext::PeriodicExecutionContext(const std::string& name) : ThreadedExecutionContext(name, Beat::period) {
  m_period = getPeriod();
}

PeriodicExecutionContext::~PeriodicExecutionContext() { endThread(); }

void PeriodicExecutionContext::endThread() {
  m_svc = false;
  RuntimeAccess::context(*this).halt();  // loops of authors ask isRunning()
  haltThread();
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
  if (!isSteppingThread()) coil::Task::wait();  // for the thread that m_svc has ended
  m_svc = true;
  return ThreadedExecutionContext::onStarted();
}

RTC::ReturnCode_t PeriodicExecutionContext::onStopping() {
  m_svc = false;
  const RTC::ReturnCode_t code = ThreadedExecutionContext::onStopping();
  if (code != RTC::RTC_OK) m_svc = true;
  return code;
}

void PeriodicExecutionContext::onWakeUp() {
  wakeThread();
  wakeLoop();
}

void PeriodicExecutionContext::wakeLoop() {
  m_worker.wake();
  m_workerthread.wake();
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
  return ThreadedExecutionContext::svc();
}

}  // namespace RTC

extern "C" void PeriodicExecutionContextInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("PeriodicExecutionContext", RTC::ECCreate<RTC::PeriodicExecutionContext>,
                                                      RTC::ECDelete<RTC::PeriodicExecutionContext>);
}

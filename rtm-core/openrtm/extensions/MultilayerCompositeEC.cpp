#include "rtm/MultilayerCompositeEC.h"

#include <rtm/ECFactory.h>
#include <rtm/RTObject.h>

#include "base/text.h"
#include "component/runtime_access.h"
#include "core/execution_context.h"
#include "core/workers.h"

namespace RTC_exp {

namespace {

constexpr std::size_t max_groups = 256;  // each is a thread

enum Job : int { transitions, execution };

// Members of other processes are named by address: rtcname://host/context/Arm0.rtc, rtcloc://host/category/Arm0.
std::string instance_of(const std::string& member) {
  std::string name = member.substr(member.rfind('/') + 1);
  if (name.size() < member.size() && name.ends_with(".rtc")) name.resize(name.size() - 4);
  return name;
}

}  // namespace

class MultilayerCompositeEC::Crew final : public rt::ThreadPool {};

MultilayerCompositeEC::MultilayerCompositeEC() : PeriodicExecutionContext("multilayercomposite_ec"), crew_(std::make_unique<Crew>()) {}

// The thread of the base works with what is here: it ends first.
MultilayerCompositeEC::~MultilayerCompositeEC() { endThread(); }

RTC::ReturnCode_t MultilayerCompositeEC::bindComponent(RTC::RTObject_impl* rtc) {
  if (rtc != nullptr && getComponents().empty()) {
    const std::string members = rtc->getConfigService().getConfigurationSet("default").getProperty("members");
    const auto groups = base::split_list(members, '|');
    if (groups.size() > max_groups) {
      RTC_ERROR(("composite %s: members has %zu groups, expected at most %zu", base::in_quotes(rtc->getInstanceNameString()).c_str(),
                 groups.size(), max_groups));
      return RTC::BAD_PARAMETER;
    }
    for (const std::string& group : groups) {
      const auto names = base::split_list(group);
      if (names.empty()) continue;
      ++count_;
      for (const std::string& name : names) groups_.emplace(instance_of(name), count_);
    }
    RTC::RuntimeAccess::context(*this).set_lanes(count_ + 1);
  }
  return PeriodicExecutionContext::bindComponent(rtc);
}

std::size_t MultilayerCompositeEC::laneOf(const std::string& instance_name) const {
  const auto it = groups_.find(instance_name);
  return it == groups_.end() ? 0 : it->second;
}

RTC::ReturnCode_t MultilayerCompositeEC::onStarted() {
  endThread();
  crew_->start(count_, [this](std::size_t lane, int job) {
    if (job == transitions) return invokeWorkerPreDo(lane);
    invokeWorkerDo(lane);
    invokeWorkerPostDo(lane);
  });
  return PeriodicExecutionContext::onStarted();
}

RTC::ReturnCode_t MultilayerCompositeEC::onStopping() {
  const RTC::ReturnCode_t code = PeriodicExecutionContext::onStopping();
  if (code == RTC::RTC_OK && !isSteppingThread()) crew_->stop();  // else at the next start
  return code;
}

void MultilayerCompositeEC::stepTransitions() {
  crew_->run(transitions, [this] { invokeWorkerPreDo(); });
}

void MultilayerCompositeEC::stepExecution() {
  crew_->run(execution, [this] {
    invokeWorkerDo();
    invokeWorkerPostDo();
  });
}

}  // namespace RTC_exp

extern "C" void MultilayerCompositeECInit(RTC::Manager*) {
  RTC::ExecutionContextFactory::instance().addFactory("MultilayerCompositeEC", RTC::ECCreate<RTC_exp::MultilayerCompositeEC>,
                                                      RTC::ECDelete<RTC_exp::MultilayerCompositeEC>);
}

// The periodic context of composites whose members are to run at the same time. Their parameter `members` names them in groups, "a, b | c,
// d": each group has a thread of its own (a child task) in which its members run one after the other, in the order in which they have
// joined. A cycle has two halves, and no thread begins one before all have ended the other: the transitions of everybody; then onExecute
// and onStateUpdate of everybody. The composite itself, and who is in no group, run in the context's own thread.
// More than 256 groups are refused.
#pragma once

#include <rtm/PeriodicExecutionContext.h>

#include <map>
#include <memory>
#include <string>

namespace RTC_exp {

class MultilayerCompositeEC : public RTC::PeriodicExecutionContext {
 public:
  MultilayerCompositeEC();
  ~MultilayerCompositeEC() override;

  // Reads the groups of the first owner.
  RTC::ReturnCode_t bindComponent(RTC::RTObject_impl* rtc) override;

 protected:
  RTC::ReturnCode_t onStarted() override;
  RTC::ReturnCode_t onStopping() override;
  std::size_t laneOf(const std::string& instance_name) const override;
  void stepTransitions() override;
  void stepExecution() override;

 private:
  std::map<std::string, std::size_t> groups_;  // by member, from 1; written before anybody else knows the context
  std::size_t count_ = 0;
  class Crew;
  std::unique_ptr<Crew> crew_;
};

}  // namespace RTC_exp

extern "C" void MultilayerCompositeECInit(RTC::Manager* manager);

// ClockGenerator: OpenHRP's clock, for components from that world, which join simulated time by themselves. It is bound in the root of the
// naming services as `ClockGenerator` from its initialisation to its end; contexts subscribe themselves there when they start, and
// unsubscribe when they stop.
//
// Each context that subscribes gets a SimTimeProxy in this process, which ticks it at the first step at or after each multiple of its
// period, under the name of its owner. Both calls return at once: what they ask for is done in their order on a thread of the component's
// own, since the contexts are asked in turn, perhaps in the middle of a tick. A second subscription of a context takes the place of the
// first. What is no period is rejected with CORBA::BAD_PARAM.
//
// Configuration: phase (1) and server_id of those who subscribe from then on.
#pragma once

#include <base/guarded.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>
#include <rtm/idl/ClockGeneratorSkel.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <thread>
#include <vector>

class ClockGenerator : public RTC::DataFlowComponentBase {
 public:
  explicit ClockGenerator(RTC::Manager* manager);
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onFinalize() override;

 private:
  using Context = OpenRTM::ExtTrigExecutionContextService_ptr;
  class Service;
  struct Subscription {
    OpenRTM::ExtTrigExecutionContextService_var context;
    RTC::RTObject_var proxy;
  };

  bool post(std::function<void()> job);
  void run(const std::stop_token& stop);
  void subscribe(Context context, double period);
  void unsubscribe(Context context);
  void bind();
  void unbind();

  int server_id_ = 0, phase_ = 1;
  std::vector<Subscription> subscriptions_;  // the thread's
  int made_ = 0;                             // proxies so far; the thread's
  OpenHRP::ClockGenerator_var reference_;
  PortableServer::ServantBase_var servant_;
  base::Guarded<std::deque<std::function<void()>>, base::Rank::queue> jobs_;
  std::condition_variable_any posted_;
  std::jthread thread_;  // last: it uses the others
};

extern "C" {
DLL_EXPORT void ClockGeneratorInit(RTC::Manager* manager);
}

// Runs its components at a rate, on a thread of its own, with absolute deadlines: the mean rate is the one asked for. The thread sleeps
// while no component is active or changes its state. Classic contexts derive from it and replace svc().
#pragma once

#include <coil/Guard.h>
#include <coil/Mutex.h>
#include <coil/TimeValue.h>
#include <rtm/ContextThread.h>
#include <rtm/PeriodicLoop.h>

#include <atomic>
#include <vector>

namespace RTC {

class Manager;

class PeriodicExecutionContext : public ThreadedExecutionContext<POA_RTC::ExecutionContextService> {
 public:
  explicit PeriodicExecutionContext(const std::string& name = "periodic_ec");
  ~PeriodicExecutionContext() override;

  // Also takes cpu_affinity (a comma list of processor numbers), priority (1-99: real-time scheduling) and stack_size (like 256k).
  void init(coil::Properties& props) override;

  int svc() override;

 protected:
  RTC::ReturnCode_t onStarted() override;
  RTC::ReturnCode_t onStopping() override;
  void onWakeUp() override;
  // For destructors of derived classes whose members the thread uses: ends it and waits for that.
  void endThread();

  // What svc() of sources of 1.x and 2.x reads; a loop may as well call threadRunning, getPeriod, invokeWorkerPreDo, Do and PostDo, or step
  // its members one by one. Nobody here makes running_ false; who asks for a transition, and the end of the thread, make it true.
  using Guard = coil::Guard<coil::Mutex>;
  using Comp = detail::LoopMember;
  using CompItr = detail::LoopMembers::iterator;
  struct invoke_worker {
    void operator()(const Comp& member) const { member.run(); }
  };
  struct find_comp {
    RTC::LightweightRTObject_var component;
    explicit find_comp(RTC::LightweightRTObject_ptr which) : component(RTC::LightweightRTObject::_duplicate(which)) {}
    bool operator()(const Comp& member) const { return member._sm.is(component); }
  };
  detail::LoopMembers m_comps{*this};
  detail::NamedWorker m_worker{*this};  // 1.1: the thread's state; 1.2 and 2.x: the members
  detail::LoopWorker m_workerthread;    // 1.2 and 2.x
  coil::Mutex m_svcmutex;
  std::atomic<bool> m_svc{false};        // as threadRunning
  std::atomic<bool>& m_running = m_svc;  // 1.0
  bool m_nowait = false;
  coil::TimeValue m_period;  // written by set_rate on the caller's thread, as ever
  RTC::ReturnCode_t onSetRate(double rate) override;

 private:
  void wakeLoop();

  std::vector<unsigned> processors_;
  int priority_ = 0;
};

}  // namespace RTC

// The name that 1.2 and 2.x give it.
namespace RTC_exp {
using RTC::PeriodicExecutionContext;
}

extern "C" void PeriodicExecutionContextInit(RTC::Manager* manager);

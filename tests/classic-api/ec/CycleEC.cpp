// -*- C++ -*-
// A context with an interface of its own, whose loop knows nothing but workerDo and isRunning.
#include <rtm/RTC.h>
#include <coil/Mutex.h>
#include <coil/Condition.h>
#include <coil/Task.h>
#include <rtm/Manager.h>
#include <rtm/PeriodicExecutionContext.h>
#include <rtm/RTObjectStateMachine.h>
#include "CycleProfileSkel.h"

#include <time.h>
#include <vector>

namespace Shop_impl
{
  class CycleEC
    : public virtual RTC_exp::PeriodicExecutionContext,
      public virtual POA_Shop::CycleProfile,
      public virtual PortableServer::RefCountServantBase
  {
  public:
    CycleEC() : RTC_exp::PeriodicExecutionContext(), m_cycles(0)
    {
      rtclog.setName("CycleEC");
    }
    virtual ~CycleEC() {}
    virtual void tick() {}
    virtual int svc(void)
    {
      coil::TimeValue period(getPeriod());
      long nsec = (double)period * 1e9;
      do
        {
          struct timespec ts = {nsec / 1000000000, nsec % 1000000000};
          nanosleep(&ts, NULL);
          const RTC::RTCList& list = getComponentList();
          std::vector<CORBA::ULong> runs(list.length());
          for (unsigned int i = 0; i < list.length(); i++)
            {
              RTC_impl::RTObjectStateMachine* rtobj = m_worker.findComponent(list[i]);
              rtobj->workerDo();
              runs[i] = (i < m_runs.size() ? m_runs[i] : 0) + (rtobj->getState() == RTC::ACTIVE_STATE ? 1 : 0);
            }
          m_runs = runs;
          m_cycles++;
        } while (isRunning());
      return 0;
    }
    CORBA::ULong cycles() { return m_cycles; }
    CORBA::ULong runs_of(RTC::LightweightRTObject_ptr member)
    {
      const RTC::RTCList& list = getComponentList();
      for (size_t i = 0; i < list.length(); i++)
        {
          RTC_impl::RTObjectStateMachine* rtobj = m_worker.findComponent(list[i]);
          if (rtobj->isEquivalent(member)) return m_runs[i];
        }
      throw Shop::CycleProfile::NotHere("no such component");
    }

  private:
    CORBA::ULong m_cycles;
    std::vector<CORBA::ULong> m_runs;
  };
};

extern "C"
{
  DLL_EXPORT void CycleECInit(RTC::Manager* manager)
  {
    RTC::ExecutionContextFactory::instance().addFactory("CycleEC",
                                                        ::coil::Creator< ::RTC::ExecutionContextBase, Shop_impl::CycleEC>,
                                                        ::coil::Destructor< ::RTC::ExecutionContextBase, Shop_impl::CycleEC>);
  }
};

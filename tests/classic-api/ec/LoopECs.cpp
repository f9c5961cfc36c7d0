// -*- C++ -*-
// Contexts whose authors have written the loop themselves, one in the style of each version.
#include <rtm/RTC.h>
#include <rtm/Manager.h>
#include <rtm/PeriodicExecutionContext.h>
#include <rtm/ECFactory.h>
#include <coil/OS.h>
#include <coil/Time.h>
#include <coil/TimeValue.h>
#include <coil/Guard.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

// 1.1
class MembersLoop : public virtual RTC::PeriodicExecutionContext
{
public:
  MembersLoop() : PeriodicExecutionContext() {}
  virtual ~MembersLoop()
  {
    m_worker.mutex_.lock();
    m_worker.running_ = true;
    m_worker.cond_.signal();
    m_worker.mutex_.unlock();
    m_svc = false;
    wait();
  }
  virtual int svc(void)
  {
    RTC_TRACE(("svc()"));
    int count(0);
    do
      {
        m_worker.mutex_.lock();
        while (!m_worker.running_)
          {
            m_worker.cond_.wait();
          }
        coil::TimeValue t0(coil::gettimeofday());
        if (m_worker.running_)
          {
            std::for_each(m_comps.begin(), m_comps.end(), invoke_worker());
          }
        m_worker.mutex_.unlock();
        coil::TimeValue t1(coil::gettimeofday());
        if (count++ % 1000 == 0)
          {
            RTC_PARANOID(("Period: %f [s]", (double)m_period));
          }
        if (!m_nowait && m_period > (t1 - t0))
          {
            coil::sleep((coil::TimeValue)(double(m_period) - double(t1 - t0)));
          }
      } while (m_svc);
    return 0;
  }
};

// 1.1, measuring its members
class TimedLoop : public virtual RTC::PeriodicExecutionContext
{
public:
  TimedLoop() : PeriodicExecutionContext() {}
  virtual int svc(void)
  {
    std::vector<std::string> rtc_names;
    do
      {
        coil::Guard<coil::Mutex> guard(m_worker.mutex_);
        while (!m_worker.running_)
          {
            m_worker.cond_.wait();
          }
        std::vector<double> processTimes(m_comps.size());
        for (unsigned int i = 0; i < m_comps.size(); i++)
          {
            coil::TimeValue before(coil::gettimeofday());
            invoke_worker()(m_comps[i]);
            coil::TimeValue after(coil::gettimeofday());
            processTimes[i] = double(after - before);
          }
        if (rtc_names.size() != processTimes.size())
          {
            rtc_names.clear();
            for (unsigned int i = 0; i < m_comps.size(); i++)
              {
                RTC::RTObject_var rtc = RTC::RTObject::_narrow(m_comps[i]._ref);
                RTC::ComponentProfile_var profile = rtc->get_component_profile();
                rtc_names.push_back(std::string(profile->instance_name));
                std::cout << "member " << rtc_names.back() << " of " << m_period.usec() << " us" << std::endl;
              }
          }
        coil::usleep(static_cast<useconds_t>(m_period.sec() * 1e6 + m_period.usec()));
      } while (m_svc);
    return 0;
  }
};

// 1.2
class PhasesLoop : public virtual RTC_exp::PeriodicExecutionContext
{
public:
  virtual int svc(void)
  {
    do
      {
        ExecutionContextBase::invokeWorkerPreDo();
        {
          Guard guard(m_workerthread.mutex_);
          while (!m_workerthread.running_)
            {
              m_workerthread.cond_.wait();
            }
        }
        coil::TimeValue t0(coil::gettimeofday());
        ExecutionContextBase::invokeWorkerDo();
        ExecutionContextBase::invokeWorkerPostDo();
        coil::TimeValue t1(coil::gettimeofday());
        coil::TimeValue period(getPeriod());
        if (!m_nowait && period > (t1 - t0))
          {
            coil::sleep((coil::TimeValue)(period - (t1 - t0)));
          }
      } while (threadRunning());
    return 0;
  }
};

// 2.x
class ChronoLoop : public virtual RTC_exp::PeriodicExecutionContext
{
public:
  ~ChronoLoop() override
  {
    {
      std::lock_guard<std::mutex> guard(m_svcmutex);
      m_svc = false;
    }
    {
      std::lock_guard<std::mutex> guard(m_workerthread.mutex_);
      m_workerthread.running_ = true;
      m_workerthread.cond_.notify_one();
    }
    wait();
  }
  int svc() override
  {
    do
      {
        ExecutionContextBase::invokeWorkerPreDo();
        {
          std::unique_lock<std::mutex> guard(m_workerthread.mutex_);
          while (!m_workerthread.running_)
            {
              m_workerthread.cond_.wait(guard);
            }
        }
        auto t0 = std::chrono::high_resolution_clock::now();
        ExecutionContextBase::invokeWorkerDo();
        ExecutionContextBase::invokeWorkerPostDo();
        auto elapsed = std::chrono::high_resolution_clock::now() - t0;
        auto period = getPeriod();
        if (!m_nowait && period > elapsed)
          {
            std::this_thread::sleep_for(period - elapsed);
          }
      } while (threadRunning());
    return 0;
  }
};

extern "C"
{
  DLL_EXPORT void LoopECsInit(RTC::Manager* manager)
  {
    manager->registerECFactory("MembersLoop", RTC::ECCreate<MembersLoop>, RTC::ECDelete<MembersLoop>);
    manager->registerECFactory("TimedLoop", RTC::ECCreate<TimedLoop>, RTC::ECDelete<TimedLoop>);
    manager->registerECFactory("PhasesLoop", RTC::ECCreate<PhasesLoop>, RTC::ECDelete<PhasesLoop>);
    RTC::ExecutionContextFactory::instance().addFactory("ChronoLoop",
                                                        ::coil::Creator< ::RTC::ExecutionContextBase, ChronoLoop>,
                                                        ::coil::Destructor< ::RTC::ExecutionContextBase, ChronoLoop>);
  }
};

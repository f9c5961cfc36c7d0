// Execution contexts of authors: one derived from the periodic context, one from the base with a thread of its own; registered in both ways.
#include <rtm/Manager.h>
#include <rtm/ExecutionContextBase.h>
#include <rtm/PeriodicExecutionContext.h>
#include <rtm/ECFactory.h>
#include <rtm/RTC.h>
#include <coil/Task.h>
#include <coil/Mutex.h>
#include <coil/Condition.h>
#include <coil/Guard.h>

namespace RTC
{
  // 1.x: replaces the loop of the periodic context.
  class OwnLoopEC
    : public virtual PeriodicExecutionContext
  {
  public:
    OwnLoopEC() : PeriodicExecutionContext() {}
    virtual ~OwnLoopEC() {}
    virtual int svc(void)
    {
      do
        {
          ExecutionContextBase::invokeWorkerPreDo();
          ExecutionContextBase::invokeWorkerDo();
          ExecutionContextBase::invokeWorkerPostDo();
          coil::TimeValue period(getPeriod());
          coil::sleep(period);
        } while (threadRunning());
      return 0;
    }
  };

  // 2.x: base, task and servant put together by the author.
  class StepEC
    : public virtual PortableServer::RefCountServantBase,
      public virtual POA_RTC::ExecutionContextService,
      public RTC::ExecutionContextBase,
      public coil::Task
  {
  public:
    StepEC() : ExecutionContextBase("step_ec"), m_running(false), m_cond(m_mutex)
    {
      setObjRef(this->_this());
      setKind(RTC::PERIODIC);
      setRate(100.0);
    }
    ~StepEC() override {}

    void init(coil::Properties& props) override { ExecutionContextBase::init(props); }

    int open(void*) override
    {
      activate();
      return 0;
    }
    int svc() override
    {
      while (isThreadRunning())
        {
          ExecutionContextBase::invokeWorkerPreDo();
          ExecutionContextBase::invokeWorkerDo();
          ExecutionContextBase::invokeWorkerPostDo();
          coil::Guard<coil::Mutex> guard(m_mutex);
          m_cond.wait(0, 1000000);
        }
      return 0;
    }
    int close(unsigned long) override { return 0; }

    CORBA::Boolean is_running() override { return ExecutionContextBase::isRunning(); }
    RTC::ReturnCode_t start() override { return ExecutionContextBase::start(); }
    RTC::ReturnCode_t stop() override { return ExecutionContextBase::stop(); }
    CORBA::Double get_rate() override { return ExecutionContextBase::getRate(); }
    RTC::ReturnCode_t set_rate(CORBA::Double rate) override { return ExecutionContextBase::setRate(rate); }
    RTC::ReturnCode_t add_component(RTC::LightweightRTObject_ptr comp) override { return ExecutionContextBase::addComponent(comp); }
    RTC::ReturnCode_t remove_component(RTC::LightweightRTObject_ptr comp) override { return ExecutionContextBase::removeComponent(comp); }
    RTC::ReturnCode_t activate_component(RTC::LightweightRTObject_ptr comp) override { return ExecutionContextBase::activateComponent(comp); }
    RTC::ReturnCode_t deactivate_component(RTC::LightweightRTObject_ptr comp) override { return ExecutionContextBase::deactivateComponent(comp); }
    RTC::ReturnCode_t reset_component(RTC::LightweightRTObject_ptr comp) override { return ExecutionContextBase::resetComponent(comp); }
    RTC::LifeCycleState get_component_state(RTC::LightweightRTObject_ptr comp) override { return ExecutionContextBase::getComponentState(comp); }
    RTC::ExecutionKind get_kind() override { return ExecutionContextBase::getKind(); }
    RTC::ExecutionContextProfile* get_profile() override { return ExecutionContextBase::getProfile(); }

  protected:
    RTC::ReturnCode_t onStarted() override
    {
      {
        coil::Guard<coil::Mutex> guard(m_mutex);
        m_running = true;
      }
      this->open(nullptr);
      return RTC::RTC_OK;
    }
    RTC::ReturnCode_t onStopping() override
    {
      {
        coil::Guard<coil::Mutex> guard(m_mutex);
        m_running = false;
        m_cond.broadcast();
      }
      this->wait();
      return RTC::RTC_OK;
    }
    RTC::ReturnCode_t onWaitingActivated(RTC_impl::RTObjectStateMachine* /*comp*/, long int /*count*/) override { return RTC::RTC_OK; }
    RTC::ReturnCode_t onActivated(RTC_impl::RTObjectStateMachine* /*comp*/, long int /*count*/) override { return RTC::RTC_OK; }

  private:
    bool isThreadRunning()
    {
      coil::Guard<coil::Mutex> guard(m_mutex);
      return m_running;
    }
    bool m_running;
    coil::Mutex m_mutex;
    coil::Condition<coil::Mutex> m_cond;
  };
}

extern "C"
{
  DLL_EXPORT void OwnLoopECInit(RTC::Manager* manager)
  {
    manager->registerECFactory("OwnLoopEC",
                               RTC::ECCreate<RTC::OwnLoopEC>,
                               RTC::ECDelete<RTC::OwnLoopEC>);
  }
  DLL_EXPORT void StepECInit(RTC::Manager* /*manager*/)
  {
    RTC::ExecutionContextFactory::
      instance().addFactory("StepEC",
                            ::coil::Creator< ::RTC::ExecutionContextBase,
                            ::RTC::StepEC>,
                            ::coil::Destructor< ::RTC::ExecutionContextBase,
                            ::RTC::StepEC>);
  }
};

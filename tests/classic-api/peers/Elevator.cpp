// -*- C++ -*-
// <rtc-template block="description">
/*!
 * @file  Elevator.cpp
 * @brief A lift as a state machine with an event port, in the manner of 2.0
 */
// </rtc-template>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>

#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/StaticFSM.h>
#include <rtm/EventPort.h>

#include <iostream>

namespace ElevatorFsm
{
  FSM_TOPSTATE(Top)
  {
    // What all states share.
    struct Box
    {
      Box() : floor(0) {}
      int floor;
    };

    FSM_STATE(Top);

    virtual void call(RTC::TimedLong floor) {}
    virtual void arrived() {}
    virtual void stop() {}

   private:
    RTC::ReturnCode_t onInit() override;
  };

  FSM_SUBSTATE(Waiting, Top)
  {
    FSM_STATE(Waiting);
    void call(RTC::TimedLong floor) override;
   private:
    RTC::ReturnCode_t onEntry() override { std::cout << "waiting" << std::endl; return RTC::RTC_OK; }
  };

  FSM_SUBSTATE(Moving, Top)
  {
    FSM_STATE(Moving);
    void arrived() override;
    void stop() override;
   private:
    RTC::ReturnCode_t onEntry() override { std::cout << "moving to " << TOP::box().floor << std::endl; return RTC::RTC_OK; }
    RTC::ReturnCode_t onExit() override { std::cout << "at rest" << std::endl; return RTC::RTC_OK; }
  };

  inline RTC::ReturnCode_t Top::onInit() { setState<Waiting>(); return RTC::RTC_OK; }
  inline void Waiting::call(RTC::TimedLong floor)
  {
    TOP::box().floor = static_cast<int>(floor.data);
    setState<Moving>();
  }
  inline void Moving::arrived() { setState<Waiting>(); }
  inline void Moving::stop() { setState<Waiting>(); }
} // namespace ElevatorFsm

class Elevator
  : public RTC::DataFlowComponentBase
{
 public:
  Elevator(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      m_fsm(this),
      m_eventIn("event", m_fsm),
      m_floorOut("floor", m_floor)
  {
  }
  ~Elevator() override = default;

  RTC::ReturnCode_t onInitialize() override
  {
    addInPort("event", m_eventIn);
    addOutPort("floor", m_floorOut);
    m_eventIn.bindEvent("call", &ElevatorFsm::Top::call);
    m_eventIn.bindEvent("arrived", &ElevatorFsm::Top::arrived);
    m_eventIn.bindEvent("stop", &ElevatorFsm::Top::stop);
    return RTC::RTC_OK;
  }

  RTC::ReturnCode_t onExecute(RTC::UniqueId /*ec_id*/) override
  {
    m_fsm.run_event();
    return RTC::RTC_OK;
  }

 private:
  RTC::Machine<ElevatorFsm::Top> m_fsm;
  RTC::EventInPort<RTC::Machine<ElevatorFsm::Top>> m_eventIn;
  RTC::TimedLong m_floor;
  RTC::OutPort<RTC::TimedLong> m_floorOut;
};

static const char* const elevator_spec[] =
  {
    "implementation_id", "Elevator",
    "type_name",         "Elevator",
    "description",       "A lift as a state machine",
    "version",           "2.0.0",
    "vendor",            "peer",
    "category",          "fsm",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "1",
    "language",          "C++",
    "lang_type",         "compile",
    "exec_cxt.periodic.rate", "100",
    ""
  };

extern "C"
{
  DLL_EXPORT void ElevatorInit(RTC::Manager* manager)
  {
    coil::Properties profile(elevator_spec);
    manager->registerFactory(profile, RTC::Create<Elevator>, RTC::Delete<Elevator>);
  }
}

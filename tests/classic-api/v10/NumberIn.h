// A source in the manner of the 1.0 generator: C++98, initialisation list with the ports, template markers.
#ifndef NUMBERIN_H
#define NUMBERIN_H

#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>

// Service implementation headers
// <rtc-template block="service_impl_h">

// </rtc-template>

// Service Consumer stub headers
// <rtc-template block="consumer_stub_h">

// </rtc-template>

using namespace RTC;

class NumberIn
  : public RTC::DataFlowComponentBase
{
 public:
  NumberIn(RTC::Manager* manager);
  ~NumberIn();

  virtual RTC::ReturnCode_t onInitialize();

  // virtual RTC::ReturnCode_t onFinalize();
  // virtual RTC::ReturnCode_t onStartup(RTC::UniqueId ec_id);
  // virtual RTC::ReturnCode_t onShutdown(RTC::UniqueId ec_id);
  virtual RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id);
  virtual RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id);
  virtual RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id);

 protected:
  // DataInPort declaration
  // <rtc-template block="inport_declare">

  // </rtc-template>

  // DataOutPort declaration
  // <rtc-template block="outport_declare">
  TimedLong m_out;
  OutPort<TimedLong> m_outOut;

  // </rtc-template>

 private:
  int m_count;
};


extern "C"
{
  DLL_EXPORT void NumberInInit(RTC::Manager* manager);
};

#endif // NUMBERIN_H

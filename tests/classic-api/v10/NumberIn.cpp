#include "NumberIn.h"
#include <iostream>

using namespace std;

// Module specification
// <rtc-template block="module_spec">
static const char* numberin_spec[] =
  {
    "implementation_id", "NumberIn",
    "type_name",         "NumberIn",
    "description",       "Counting component",
    "version",           "1.0",
    "vendor",            "Somebody",
    "category",          "example",
    "activity_type",     "DataFlowComponent",
    "max_instance",      "10",
    "language",          "C++",
    "lang_type",         "compile",
    ""
  };
// </rtc-template>

NumberIn::NumberIn(RTC::Manager* manager)
    // <rtc-template block="initializer">
  : RTC::DataFlowComponentBase(manager),
    m_outOut("out", m_out),

    // </rtc-template>
    m_count(0)
{
  // Registration: InPort/OutPort/Service
  // <rtc-template block="registration">
  // Set InPort buffers

  // Set OutPort buffer
  registerOutPort("out", m_outOut);

  // </rtc-template>
}

NumberIn::~NumberIn()
{
}

RTC::ReturnCode_t NumberIn::onInitialize()
{
  coil::Properties& prop(getProperties());
  if (prop.getProperty("start") != "") {
    coil::stringTo(m_count, prop["start"].c_str());
  }
  return RTC::RTC_OK;
}

RTC::ReturnCode_t NumberIn::onActivated(RTC::UniqueId ec_id)
{
  cout << "activated in " << ec_id << endl;
  return RTC::RTC_OK;
}

RTC::ReturnCode_t NumberIn::onDeactivated(RTC::UniqueId)
{
  return RTC::RTC_OK;
}

RTC::ReturnCode_t NumberIn::onExecute(RTC::UniqueId ec_id)
{
  (void)ec_id;
  m_out.data = m_count++;
  coil::TimeValue tm(coil::gettimeofday());
  m_out.tm.sec = tm.sec();
  m_out.tm.nsec = tm.usec() * 1000;
  m_outOut.write();
  return RTC::RTC_OK;
}

extern "C"
{
  void NumberInInit(RTC::Manager* manager)
  {
    coil::Properties profile(numberin_spec);
    manager->registerFactory(profile,
                             RTC::Create<NumberIn>,
                             RTC::Delete<NumberIn>);
  }
};

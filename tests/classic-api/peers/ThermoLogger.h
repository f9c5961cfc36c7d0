// -*- C++ -*-
/*!
 * @file  ThermoLogger.h
 * @brief Averages temperatures and reports them
 * @date  $Date$
 *
 * $Id$
 */

#ifndef THERMOLOGGER_H
#define THERMOLOGGER_H

#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <coil/Mutex.h>
#include <coil/Guard.h>
#include <coil/Condition.h>
#include <coil/Time.h>
#include <coil/TimeValue.h>
#include <coil/stringutil.h>

#include <deque>

using namespace RTC;

class ArrivalListener
  : public ConnectorDataListenerT<TimedDouble>
{
public:
  ArrivalListener(int& count) : m_count(count) {}
  virtual ~ArrivalListener() {}
  virtual void operator()(const ConnectorInfo& info, const TimedDouble& data)
  {
    ++m_count;
  }
private:
  int& m_count;
};

class LinkListener
  : public ConnectorListener
{
public:
  LinkListener(const char* name) : m_name(name) {}
  virtual void operator()(const ConnectorInfo& info)
  {
    std::cout << m_name << ": " << info.name << std::endl;
  }
private:
  std::string m_name;
};

class ThermoLogger
  : public RTC::DataFlowComponentBase
{
 public:
  ThermoLogger(RTC::Manager* manager);
  ~ThermoLogger();

  virtual RTC::ReturnCode_t onInitialize();
  virtual RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id);
  virtual RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id);
  virtual RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id);

 protected:
  int m_window;
  std::string m_unit;

  TimedDouble m_temperature;
  InPort<TimedDouble> m_temperatureIn;
  TimedDouble m_mean;
  OutPort<TimedDouble> m_meanOut;
  TimedString m_report;
  OutPort<TimedString> m_reportOut;

 private:
  typedef coil::Guard<coil::Mutex> Guard;
  coil::Mutex m_mutex;
  std::deque<double> m_values;
  int m_arrived;
  coil::TimeValue m_start;
};


extern "C"
{
  DLL_EXPORT void ThermoLoggerInit(RTC::Manager* manager);
};

#endif // THERMOLOGGER_H

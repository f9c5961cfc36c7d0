// -*- C++ -*-
/*!
 * @file  ThermoLogger.cpp
 * @brief Averages temperatures and reports them
 * @date $Date$
 *
 * $Id$
 */

#include "ThermoLogger.h"

// Module specification
// <rtc-template block="module_spec">
static const char* thermologger_spec[] =
  {
    "implementation_id", "ThermoLogger",
    "type_name",         "ThermoLogger",
    "description",       "Averages temperatures and reports them",
    "version",           "1.0.0",
    "vendor",            "peer",
    "category",          "sensor",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "1",
    "language",          "C++",
    "lang_type",         "compile",
    "exec_cxt.periodic.rate", "50.0",
    // Configuration variables
    "conf.default.window", "4",
    "conf.default.unit", " Celsius ",
    // Widget
    "conf.__widget__.window", "spin",
    "conf.__widget__.unit", "radio",
    // Constraints
    "conf.__constraints__.window", "1<=x<=100",
    "conf.__constraints__.unit", "(Celsius,Kelvin)",
    ""
  };
// </rtc-template>

ThermoLogger::ThermoLogger(RTC::Manager* manager)
    // <rtc-template block="initializer">
  : RTC::DataFlowComponentBase(manager),
    m_temperatureIn("temperature", m_temperature),
    m_meanOut("mean", m_mean),
    m_reportOut("report", m_report),
    m_arrived(0)
    // </rtc-template>
{
}

ThermoLogger::~ThermoLogger()
{
}

RTC::ReturnCode_t ThermoLogger::onInitialize()
{
  // Registration: InPort/OutPort/Service
  registerInPort("temperature", m_temperatureIn);
  registerOutPort("mean", m_meanOut);
  registerOutPort("report", m_reportOut);

  m_temperatureIn.addConnectorDataListener(ON_BUFFER_WRITE, new ArrivalListener(m_arrived));
  m_temperatureIn.addConnectorListener(ON_CONNECT, new LinkListener("ON_CONNECT"));
  m_temperatureIn.addConnectorListener(ON_DISCONNECT, new LinkListener("ON_DISCONNECT"));

  // Bind variables and configuration variable
  bindParameter("window", m_window, "4");
  bindParameter("unit", m_unit, "Celsius");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t ThermoLogger::onActivated(RTC::UniqueId ec_id)
{
  Guard guard(m_mutex);
  m_values.clear();
  m_start = coil::gettimeofday();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t ThermoLogger::onDeactivated(RTC::UniqueId ec_id)
{
  coil::TimeValue past(coil::gettimeofday() - m_start);
  RTC_INFO(("%d samples in %f s", m_arrived, (double)past));
  return RTC::RTC_OK;
}

RTC::ReturnCode_t ThermoLogger::onExecute(RTC::UniqueId ec_id)
{
  if (!m_temperatureIn.isNew()) { return RTC::RTC_OK; }
  while (!m_temperatureIn.isEmpty())
    {
      m_temperatureIn.read();
      Guard guard(m_mutex);
      m_values.push_back(m_temperature.data);
      while (m_values.size() > (size_t)m_window) { m_values.pop_front(); }
    }

  double sum(0.0);
  for (size_t i(0), len(m_values.size()); i < len; ++i) { sum += m_values[i]; }
  m_mean.data = sum / m_values.size();
  m_mean.tm = m_temperature.tm;
  m_meanOut.write();

  std::string unit(m_unit);
  coil::eraseBothEndsBlank(unit);
  coil::normalize(unit);
  coil::replaceString(unit, "celsius", "C");
  std::string line("mean " + coil::otos(m_mean.data) + " " + unit);
  m_report.data = CORBA::string_dup(line.c_str());
  setTimestamp(m_report);
  m_reportOut.write();
  std::cout << line << std::endl;
  return RTC::RTC_OK;
}

extern "C"
{

  void ThermoLoggerInit(RTC::Manager* manager)
  {
    coil::Properties profile(thermologger_spec);
    manager->registerFactory(profile,
                             RTC::Create<ThermoLogger>,
                             RTC::Delete<ThermoLogger>);
  }

};

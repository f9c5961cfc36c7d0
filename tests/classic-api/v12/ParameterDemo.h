// Configuration in the manner of 1.2: bound parameters of many types, vectors, an own conversion, listeners of the component.
#ifndef PARAMETERDEMO_H
#define PARAMETERDEMO_H

#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/ComponentActionListener.h>
#include <rtm/ConfigurationListener.h>
#include "VectorConvert.h"

struct ParameterDemo_Position
{
  double x;
  double y;
};

// <rtc-template block="component_description">
/*!
 * @class ParameterDemo
 */
// </rtc-template>
class ParameterDemo
  : public RTC::DataFlowComponentBase
{
 public:
  ParameterDemo(RTC::Manager* manager);
  ~ParameterDemo();
  virtual RTC::ReturnCode_t onInitialize();
  virtual RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id);

  void configUpdated(const char* config_set, const char* config_param);
  void setAdded(const coil::Properties& config_set);
  void setActivated(const char* config_set);
  void preExecute(RTC::UniqueId ec_id);
  void postExecute(RTC::UniqueId ec_id, RTC::ReturnCode_t ret);
  void portAdded(const RTC::PortProfile& profile);
  void ecAttached(RTC::UniqueId ec_id);
  void portConnected(const char* portname, RTC::ConnectorProfile& profile);
  void portConnectedRet(const char* portname, RTC::ConnectorProfile& profile, RTC::ReturnCode_t ret);

 protected:
  int m_int_param0;
  unsigned short m_ushort_param;
  double m_double_param0;
  float m_float_param;
  bool m_bool_param;
  std::string m_str_param0;
  std::vector<double> m_vector_param0;
  std::vector<std::string> m_names;
  char m_char_param;
  ParameterDemo_Position m_position;
};

#endif

// -*- C++ -*-
// <rtc-template block="description">
/*!
 * @file  Gauge.cpp
 * @brief Times what arrives, with listeners that are templates, in the manner of 1.1 and 1.2
 */
// </rtc-template>
#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/InPortConnector.h>
#include <rtm/OutPortConnector.h>
#include <rtm/FsmActionListener.h>
#include <rtm/RTCUtil.h>
#include <rtm/idl/BasicDataTypeSkel.h>

using namespace RTC;

class Gauge;

template <class DataType>
class GaugeListener
  : public ConnectorDataListenerT<DataType>
{
  USE_CONNLISTENER_STATUS;
public:
  GaugeListener(Gauge* comp) : m_comp(comp) {}
  virtual ReturnCode operator()(ConnectorInfo& info, DataType& data);
private:
  Gauge* m_comp;
};

// The type that the operators return, written out.
class GaugeConnection
  : public ConnectorListener
{
public:
  virtual ConnectorListenerStatus::Enum operator()(ConnectorInfo& info)
  {
    std::cout << info.name << std::endl;
    return NO_CHANGE;
  }
};

class GaugeUpdate
  : public OnUpdateCallback
{
public:
  void operator()(const char* config_set) { std::cout << "set: " << config_set << std::endl; }
};

class Gauge
  : public RTC::DataFlowComponentBase
{
  typedef coil::Guard<coil::Mutex> Guard;
public:
  Gauge(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager), m_seqIn("in", m_seq), m_naming(NULL), m_timer(NULL) {}
  virtual RTC::ReturnCode_t onInitialize()
  {
    addInPort("in", m_seqIn);
    m_seqIn.addConnectorDataListener(ON_BUFFER_WRITE, new GaugeListener<RTC::TimedLongSeq>(this));
    m_seqIn.addConnectorListener(ON_CONNECT, new GaugeConnection());
    m_configsets.setOnUpdate(&m_update);
    std::vector<RTC::InPortConnector*> connectors = m_seqIn.connectors();
    return RTC_Utils::isFsmParticipant(CORBA::Object::_nil()) || !connectors.empty() ? RTC::RTC_ERROR : RTC::RTC_OK;
  }
  void measure(const RTC::Time& tm, CORBA::ULong length)
  {
    Guard guard(m_mutex);
    coil::TimeValue received(coil::gettimeofday());
    coil::TimeValue sent(tm.sec, tm.nsec / 1000);
    m_latency = received - sent;
    std::cout << length << " " << m_latency << std::endl;
  }
private:
  RTC::TimedLongSeq m_seq;
  RTC::InPort<RTC::TimedLongSeq> m_seqIn;
  coil::Mutex m_mutex;
  coil::TimeValue m_latency;
  GaugeUpdate m_update;
  RTC::CorbaNaming* m_naming;
  coil::Timer* m_timer;
};

template <class DataType>
ConnectorListenerStatus::Enum GaugeListener<DataType>::operator()(ConnectorInfo& info, DataType& data)
{
  m_comp->measure(data.tm, data.data.length());
  return NO_CHANGE;
}

static const char* gauge_spec[] =
  {
    "implementation_id", "Gauge",
    "type_name",         "Gauge",
    "description",       "Times what arrives",
    "version",           "1.2.0",
    "vendor",            "somebody",
    "category",          "example",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "1",
    "language",          "C++",
    "lang_type",         "compile",
    ""
  };

extern "C"
{
  void GaugeInit(RTC::Manager* manager)
  {
    RTC::Properties profile(gauge_spec);
    manager->registerFactory(profile, RTC::Create<Gauge>, RTC::Delete<Gauge>);
  }
};

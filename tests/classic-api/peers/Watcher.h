// -*- C++ -*-
// <rtc-template block="description">
/*!
 * @file  Watcher.h
 * @brief Listens to everything, in the manner of the 2.0 generator
 */
// </rtc-template>

#ifndef WATCHER_H
#define WATCHER_H

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/ExtendedDataTypesSkel.h>
#include <rtm/idl/InterfaceDataTypesSkel.h>

#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/ComponentActionListener.h>
#include <rtm/ConnectorListener.h>
#include <rtm/PortConnectListener.h>

#include <coil/PeriodicTask.h>
#include <coil/TimeMeasure.h>
#include <coil/UUID.h>
#include <coil/Process.h>
#include <coil/File.h>
#include <coil/stringutil.h>

#include <atomic>
#include <memory>
#include <mutex>

class Doubler
  : public RTC::ConnectorDataListenerT<RTC::TimedLong>
{
  USE_CONNLISTENER_STATUS;
 public:
  ReturnCode operator()(RTC::ConnectorInfo& info, RTC::TimedLong& data) override
  {
    data.data *= 2;
    return DATA_CHANGED;
  }
};

class RawCounter
  : public RTC::ConnectorDataListener
{
  USE_CONNLISTENER_STATUS;
 public:
  explicit RawCounter(std::atomic<unsigned long>& octets) : m_octets(octets) {}
  ReturnCode operator()(RTC::ConnectorInfo& info, RTC::ByteData& data, const std::string& marshalingtype) override
  {
    m_octets += data.getDataLength();
    return NO_CHANGE;
  }
 private:
  std::atomic<unsigned long>& m_octets;
};

class Links
  : public RTC::ConnectorListener
{
  USE_CONNLISTENER_STATUS;
 public:
  explicit Links(std::string what) : m_what(std::move(what)) {}
  ReturnCode operator()(RTC::ConnectorInfo& info) override
  {
    std::cout << m_what << " " << info.name << " " << info.properties.getProperty("interface_type") << std::endl;
    return NO_CHANGE;
  }
 private:
  std::string m_what;
};

class Limit
  : public RTC::OnReadConvert<RTC::TimedLong>
{
 public:
  RTC::TimedLong operator()(const RTC::TimedLong& value) override
  {
    RTC::TimedLong limited(value);
    if (limited.data > m_max) { limited.data = m_max; }
    return limited;
  }
  CORBA::Long m_max{100};
};

class Before
  : public RTC::OnWrite<RTC::TimedLong>
{
 public:
  void operator()(const RTC::TimedLong& value) override { ++m_count; }
  int m_count{0};
};

class Watcher
  : public RTC::DataFlowComponentBase
{
 public:
  Watcher(RTC::Manager* manager);
  ~Watcher() override;
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onFinalize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

  void beforeExecute(RTC::UniqueId ec_id);
  void afterExecute(RTC::UniqueId ec_id, RTC::ReturnCode_t ret);
  void portAdded(const RTC::PortProfile& profile);
  void connected(const char* portname, RTC::ConnectorProfile& profile, RTC::ReturnCode_t ret);
  int beat();

 protected:
  // <rtc-template block="protected_attribute">
  std::string m_folder{"/"};
  int m_limit{100};
  // </rtc-template>

  RTC::TimedLong m_in;
  RTC::InPort<RTC::TimedLong> m_inIn;
  RTC::TimedLong m_out;
  RTC::OutPort<RTC::TimedLong> m_outOut;

 private:
  Limit m_convert;
  Before m_before;
  std::atomic<unsigned long> m_octets{0};
  std::atomic<int> m_beats{0};
  int m_executions{0};
  coil::TimeMeasure m_measure;
  std::unique_ptr<coil::PeriodicTask> m_task;
  RTC::PreComponentActionListener* m_pre{nullptr};
  std::string m_id;
};

extern "C"
{
  DLL_EXPORT void WatcherInit(RTC::Manager* manager);
};

#endif // WATCHER_H

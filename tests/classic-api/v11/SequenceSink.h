// A sink in the manner of 1.1: many ports, listeners of every kind with the const signature of that time.
#ifndef SEQUENCESINK_H
#define SEQUENCESINK_H

#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/ConnectorListener.h>
#include <coil/Mutex.h>
#include <coil/Guard.h>

#include <iostream>

using namespace RTC;

class DataListener
  : public ConnectorDataListenerT<RTC::TimedLong>
{
public:
  DataListener(const char* name) : m_name(name) {}
  virtual ~DataListener()
  {
    std::cout << "dtor of " << m_name << std::endl;
  }

  virtual void operator()(const ConnectorInfo& info,
                          const TimedLong& data)
  {
    std::cout << "------------------------------" << std::endl;
    std::cout << "Data Listener: " << m_name << std::endl;
    std::cout << "Profile::name: " << info.name << std::endl;
    std::cout << "Profile::id:   " << info.id << std::endl;
    std::cout << "Data:          " << data.data << std::endl;
    std::cout << "------------------------------" << std::endl;
  };
  std::string m_name;
};

class RawListener
  : public RTC::ConnectorDataListener
{
public:
  virtual void operator()(const ConnectorInfo& info, const cdrMemoryStream& data)
  {
    m_last = info.name;
    m_size = data.bufSize();
  }
  std::string m_last;
  CORBA::ULong m_size;
};

class ConnListener
  : public ConnectorListener
{
public:
  ConnListener(const char* name) : m_name(name) {}
  virtual ~ConnListener() {}

  virtual void operator()(const ConnectorInfo& info)
  {
    std::cout << "Connector Listener: " << m_name << std::endl;
    std::cout << "Profile::properties: " << std::endl;
    std::cout << info.properties;
    std::cout << info.properties.getProperty("dataflow_type") << std::endl;
  };
  std::string m_name;
};

class SequenceSink
  : public RTC::DataFlowComponentBase
{
 public:
  SequenceSink(RTC::Manager* manager);
  ~SequenceSink();
  virtual RTC::ReturnCode_t onInitialize();
  virtual RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id);

 protected:
  TimedLong m_Long;
  InPort<TimedLong> m_LongIn;
  TimedOctet m_Octet;
  InPort<TimedOctet> m_OctetIn;
  TimedString m_String;
  InPort<TimedString> m_StringIn;
  TimedDoubleSeq m_DoubleSeq;
  InPort<TimedDoubleSeq> m_DoubleSeqIn;
  TimedBooleanSeq m_BooleanSeq;
  InPort<TimedBooleanSeq> m_BooleanSeqIn;
  TimedStringSeq m_StringSeq;
  InPort<TimedStringSeq> m_StringSeqIn;

 private:
  template <typename T>
  void dump(const char* title, T& seq)
  {
    std::cout << title << ": ";
    for (CORBA::ULong i(0), len(seq.data.length()); i < len; ++i) std::cout << seq.data[i] << " ";
    std::cout << std::endl;
  }
  coil::Mutex m_mutex;
  double m_sum;
};

extern "C"
{
  DLL_EXPORT void SequenceSinkInit(RTC::Manager* manager);
};

#endif

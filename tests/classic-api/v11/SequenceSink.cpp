#include "SequenceSink.h"

// Module specification
// <rtc-template block="module_spec">
static const char* sequencesink_spec[] =
  {
    "implementation_id", "SequenceSink",
    "type_name",         "SequenceSink",
    "description",       "Sequence in port component",
    "version",           "1.1",
    "vendor",            "Somebody",
    "category",          "example",
    "activity_type",     "DataFlowComponent",
    "max_instance",      "10",
    "language",          "C++",
    "lang_type",         "compile",
    "exec_cxt.periodic.rate", "100.0",
    ""
  };
// </rtc-template>

SequenceSink::SequenceSink(RTC::Manager* manager)
  : RTC::DataFlowComponentBase(manager),
    m_LongIn("Long", m_Long),
    m_OctetIn("Octet", m_Octet),
    m_StringIn("String", m_String),
    m_DoubleSeqIn("DoubleSeq", m_DoubleSeq),
    m_BooleanSeqIn("BooleanSeq", m_BooleanSeq),
    m_StringSeqIn("StringSeq", m_StringSeq),
    m_sum(0)
{
}

SequenceSink::~SequenceSink()
{
}

RTC::ReturnCode_t SequenceSink::onInitialize()
{
  addInPort("Long", m_LongIn);
  addInPort("Octet", m_OctetIn);
  addInPort("String", m_StringIn);
  addInPort("DoubleSeq", m_DoubleSeqIn);
  addInPort("BooleanSeq", m_BooleanSeqIn);
  addInPort("StringSeq", m_StringSeqIn);

  m_LongIn.addConnectorDataListener(ON_BUFFER_WRITE, new DataListener("ON_BUFFER_WRITE"));
  m_LongIn.addConnectorDataListener(ON_BUFFER_FULL, new DataListener("ON_BUFFER_FULL"));
  m_LongIn.addConnectorDataListener(ON_BUFFER_WRITE_TIMEOUT, new DataListener("ON_BUFFER_WRITE_TIMEOUT"));
  m_LongIn.addConnectorDataListener(ON_BUFFER_OVERWRITE, new DataListener("ON_BUFFER_OVERWRITE"));
  m_LongIn.addConnectorDataListener(ON_BUFFER_READ, new DataListener("ON_BUFFER_READ"));
  m_LongIn.addConnectorDataListener(ON_SEND, new DataListener("ON_SEND"));
  m_LongIn.addConnectorDataListener(ON_RECEIVED, new DataListener("ON_RECEIVED"));
  m_LongIn.addConnectorDataListener(ON_RECEIVER_FULL, new DataListener("ON_RECEIVER_FULL"));
  m_LongIn.addConnectorDataListener(ON_RECEIVER_TIMEOUT, new DataListener("ON_RECEIVER_TIMEOUT"));
  m_LongIn.addConnectorDataListener(ON_RECEIVER_ERROR, new RawListener());
  m_LongIn.addConnectorListener(ON_BUFFER_EMPTY, new ConnListener("ON_BUFFER_EMPTY"));
  m_LongIn.addConnectorListener(ON_BUFFER_READ_TIMEOUT, new ConnListener("ON_BUFFER_READ_TIMEOUT"));
  m_LongIn.addConnectorListener(ON_SENDER_EMPTY, new ConnListener("ON_SENDER_EMPTY"));
  m_LongIn.addConnectorListener(ON_SENDER_TIMEOUT, new ConnListener("ON_SENDER_TIMEOUT"));
  m_LongIn.addConnectorListener(ON_SENDER_ERROR, new ConnListener("ON_SENDER_ERROR"));
  m_LongIn.addConnectorListener(ON_CONNECT, new ConnListener("ON_CONNECT"));
  m_LongIn.addConnectorListener(ON_DISCONNECT, new ConnListener("ON_DISCONNECT"));
  return RTC::RTC_OK;
}

RTC::ReturnCode_t SequenceSink::onExecute(RTC::UniqueId)
{
  coil::Guard<coil::Mutex> guard(m_mutex);
  if (m_LongIn.isNew())
    {
      m_LongIn.read();
      std::cout << "Long: " << m_Long.data << std::endl;
    }
  while (!m_OctetIn.isEmpty())
    {
      m_OctetIn.read();
      std::cout << "Octet: " << int(m_Octet.data) << std::endl;
    }
  m_StringIn.update();
  std::cout << "String: " << m_String.data << " " << strlen(m_String.data) << std::endl;
  if (m_DoubleSeqIn.isNew())
    {
      m_DoubleSeqIn >> m_DoubleSeq;
      dump("DoubleSeq", m_DoubleSeq);
      for (unsigned int i = 0; i < m_DoubleSeq.data.length(); i++) m_sum += m_DoubleSeq.data[i];
    }
  if (m_BooleanSeqIn.isNew() && m_BooleanSeqIn.read()) dump("BooleanSeq", m_BooleanSeq);
  if (m_StringSeqIn.isNew())
    {
      m_StringSeqIn.read();
      dump("StringSeq", m_StringSeq);
    }
  coil::usleep(1000);
  return RTC::RTC_OK;
}

extern "C"
{
  void SequenceSinkInit(RTC::Manager* manager)
  {
    coil::Properties profile(sequencesink_spec);
    manager->registerFactory(profile,
                             RTC::Create<SequenceSink>,
                             RTC::Delete<SequenceSink>);
  }
};

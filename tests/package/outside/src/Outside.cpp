#include "Outside.h"

static const char* const outside_spec[] =
  {
    "implementation_id", "Outside",
    "type_name",         "Outside",
    "description",       "A component of another project",
    "version",           "1.0.0",
    "vendor",            "Somebody",
    "category",          "outside",
    "activity_type",     "PERIODIC",
    "kind",              "DataFlowComponent",
    "max_instance",      "1",
    "language",          "C++",
    "lang_type",         "compile",
    "conf.default.gain", "3",
    ""
  };

void ServiceSVC_impl::take(const OutsideDemo::Note& what)
  throw (CORBA::SystemException)
{
  m_last = what;
}

OutsideDemo::Note* ServiceSVC_impl::last() throw (CORBA::SystemException, PortableServer::POA::WrongPolicy)
{
  if (m_last.tm.sec == 0) throw CORBA::BAD_INV_ORDER();
  return new OutsideDemo::Note(m_last);
}

Outside::Outside(RTC::Manager* manager)
  : RTC::DataFlowComponentBase(manager),
    m_inIn("in", m_in),
    m_noteOut("note", m_note),
    m_servicePort("service")
{
}

Outside::~Outside()
{
}

RTC::ReturnCode_t Outside::onInitialize()
{
  addInPort("in", m_inIn);
  addOutPort("note", m_noteOut);
  m_servicePort.registerProvider("service0", "OutsideDemo::Service", m_service);
  addPort(m_servicePort);
  bindParameter("gain", m_gain, "1");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Outside::onActivated(RTC::UniqueId)
{
  std::cout << getInstanceName() << " is active, gain " << m_gain << std::endl;
  return RTC::RTC_OK;
}

RTC::ReturnCode_t Outside::onExecute(RTC::UniqueId)
{
  if (m_inIn.isNew())
    {
      m_inIn.read();
      m_note.data = coil::otos(m_in.data * m_gain).c_str();
      setTimestamp(m_note);
      m_noteOut.write();
    }
  return RTC::RTC_OK;
}

extern "C"
{
  void OutsideInit(RTC::Manager* manager)
  {
    coil::Properties profile(outside_spec);
    manager->registerFactory(profile,
                             RTC::Create<Outside>,
                             RTC::Delete<Outside>);
  }
};

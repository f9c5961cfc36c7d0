// A service provider in the manner of 1.x; the servant is a plain member.
#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>

// Service implementation headers
// <rtc-template block="service_impl_h">
#include "SpeakerSVC_impl.h"
// </rtc-template>

using namespace RTC;

class SpeakerProvider
  : public RTC::DataFlowComponentBase
{
 public:
  SpeakerProvider(RTC::Manager* manager);
  ~SpeakerProvider();
  virtual RTC::ReturnCode_t onInitialize();

 protected:
  // CORBA Port declaration
  // <rtc-template block="corbaport_declare">
  RTC::CorbaPort m_SpeakerPort;
  // </rtc-template>

  // Service declaration
  // <rtc-template block="service_declare">
  SpeakerSVC_impl m_speaker;
  // </rtc-template>
};

static const char* speakerprovider_spec[] =
  {
    "implementation_id", "SpeakerProvider",
    "type_name",         "SpeakerProvider",
    "description",       "Service Provider Sample component",
    "version",           "1.1",
    "vendor",            "Somebody",
    "category",          "example",
    "activity_type",     "DataFlowComponent",
    "max_instance",      "10",
    "language",          "C++",
    "lang_type",         "compile",
    ""
  };

SpeakerProvider::SpeakerProvider(RTC::Manager* manager)
  : RTC::DataFlowComponentBase(manager),
    m_SpeakerPort("Speaker")
{
}

SpeakerProvider::~SpeakerProvider()
{
}

RTC::ReturnCode_t SpeakerProvider::onInitialize()
{
  // Set service provider to Ports
  m_SpeakerPort.registerProvider("speaker0", "Speaker", m_speaker);

  // Set CORBA Service Ports
  addPort(m_SpeakerPort);

  return RTC::RTC_OK;
}

extern "C"
{
  DLL_EXPORT void SpeakerProviderInit(RTC::Manager* manager)
  {
    coil::Properties profile(speakerprovider_spec);
    manager->registerFactory(profile,
                             RTC::Create<SpeakerProvider>,
                             RTC::Delete<SpeakerProvider>);
  }
};

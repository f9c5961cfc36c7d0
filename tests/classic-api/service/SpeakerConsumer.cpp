// A service consumer in the manner of 1.x, with calls in the background.
#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/CorbaConsumer.h>
#include <rtm/DataOutPort.h>
#include <coil/Async.h>

// Service Consumer stub headers
// <rtc-template block="consumer_stub_h">
#include "SpeakerStub.h"
// </rtc-template>

#include <iostream>

using namespace SpeakerDemo;
using namespace RTC;

class SpeakerConsumer
  : public RTC::DataFlowComponentBase
{
 public:
  SpeakerConsumer(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager),
      m_SpeakerPort("Speaker"),
      m_sentenceOut("sentence", m_sentence),
      async_say(0)
  {
  }
  ~SpeakerConsumer() { delete async_say; }

  virtual RTC::ReturnCode_t onInitialize()
  {
    m_SpeakerPort.registerConsumer("speaker0", "Speaker", m_speaker);
    addPort(m_SpeakerPort);
    addOutPort("sentence", m_sentenceOut);
    return RTC::RTC_OK;
  }

  class say_functor
  {
  public:
    say_functor(std::string msg, std::string& result)
      : m_msg(msg), m_result(result) {}
    void operator()(RTC::CorbaConsumer<SpeakerDemo::Speaker>* obj)
    {
      try
        {
          if (CORBA::is_nil((*obj).operator->()))
            {
              std::cout << "No service connected." << std::endl;
            }
          else
            {
              m_result = (*obj)->say(m_msg.c_str());
            }
        }
      catch (const CORBA::INV_OBJREF &)
        {
        }
      catch (const CORBA::OBJECT_NOT_EXIST &)
        {
        }
      catch (const CORBA::TRANSIENT &)
        {
        }
    }
    std::string m_msg;
    std::string& m_result;
  };

  virtual RTC::ReturnCode_t onExecute(RTC::UniqueId)
  {
    try
      {
        if (CORBA::is_nil(m_speaker._ptr())) return RTC::RTC_OK;
        CORBA::String_var answer = m_speaker->say("hello");
        std::cout << "answer: " << answer << std::endl;

        Words_var history = m_speaker->get_history();
        for (CORBA::ULong i = 0; i < history->length(); ++i) std::cout << history[i] << std::endl;

        m_speaker->set_level(0.5);
        CORBA::Long count;
        CORBA::Double effort = 1;
        Sentence sentence;
        sentence.text.length(2);
        sentence.text[0] = "two";
        sentence.text[1] = CORBA::string_dup("words");
        m_speaker->utter(sentence, count, effort);
        m_sentence.data = sentence;
        m_sentenceOut.write();
        Speaker_ptr plain = m_speaker._ptr();
        plain->get_level();

        if (async_say == 0)
          {
            async_say = coil::AsyncInvoker(&m_speaker, say_functor("again", m_result));
            async_say->invoke();
          }
        else if (async_say->finished())
          {
            async_say->wait();
            delete async_say;
            async_say = 0;
          }
      }
    catch (SpeakerDemo::Muted& e)
      {
        RTC_WARN(("muted: %s", e.reason.in()));
      }
    catch (CORBA::SystemException &e)
      {
        // ignore exceptions
        std::cout << "exception " << e._name() << std::endl;
        return RTC::RTC_ERROR;
      }
    catch (...)
      {
        return RTC::RTC_ERROR;
      }
    return RTC::RTC_OK;
  }

 private:
  RTC::CorbaPort m_SpeakerPort;
  RTC::CorbaConsumer<SpeakerDemo::Speaker> m_speaker;
  SpeakerDemo::TimedSentence m_sentence;
  RTC::OutPort<SpeakerDemo::TimedSentence> m_sentenceOut;
  coil::Async* async_say;
  std::string m_result;
};

static const char* speakerconsumer_spec[] =
  {
    "implementation_id", "SpeakerConsumer",
    "type_name",         "SpeakerConsumer",
    "description",       "Service Consumer Sample component",
    "version",           "1.1",
    "vendor",            "Somebody",
    "category",          "example",
    "activity_type",     "DataFlowComponent",
    "max_instance",      "10",
    "language",          "C++",
    "lang_type",         "compile",
    ""
  };

extern "C"
{
  DLL_EXPORT void SpeakerConsumerInit(RTC::Manager* manager)
  {
    coil::Properties profile(speakerconsumer_spec);
    manager->registerFactory(profile,
                             RTC::Create<SpeakerConsumer>,
                             RTC::Delete<SpeakerConsumer>);
  }
};

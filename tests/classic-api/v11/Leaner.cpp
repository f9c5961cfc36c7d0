// -*- C++ -*-
/*!
 * @file  Leaner.cpp
 * @brief Leans on what the headers of the API bring along
 */
#include <rtm/Manager.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/CorbaPort.h>
#include <rtm/DataInPort.h>
#include <rtm/DataOutPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>

using namespace RTC;

class Leaner;

// Works beside the component.
class Beside : public coil::Task
{
public:
  Beside(Leaner* owner) : m_owner(owner) {}
  virtual int svc();
private:
  Leaner* m_owner;
};

class Leaner
  : public RTC::DataFlowComponentBase
{
public:
  Leaner(RTC::Manager* manager)
    : RTC::DataFlowComponentBase(manager), m_inIn("in", m_in), m_beside(this), m_turns(0)
  {
  }
  virtual RTC::ReturnCode_t onInitialize()
  {
    addInPort("in", m_inIn);
    return RTC::RTC_OK;
  }
  virtual RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id)
  {
    std::ifstream file("no such file");
    if (file) return RTC::RTC_ERROR;
    std::set<std::string> names;
    std::map<std::string, int> ages;
    char text[8];
    memset(text, 0, sizeof(text));
    strcpy(text, "lean");
    assert(names.empty() && ages.empty());
    std::vector<int> numbers(3, atoi("4"));
    std::sort(numbers.begin(), numbers.end());
    std::stringstream line;
    line << std::setw(3) << std::fixed << fabs(-1.5) << text;
    std::cout << line.str() << std::endl;
    m_beside.activate();
    return RTC::RTC_OK;
  }
  virtual RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id)
  {
    m_beside.wait();
    coil::Guard<coil::Mutex> guard(m_mutex);
    return m_turns == 3 ? RTC::RTC_OK : RTC::RTC_ERROR;
  }
  void turn()
  {
    coil::Guard<coil::Mutex> guard(m_mutex);
    m_turns++;
  }

private:
  TimedLong m_in;
  InPort<TimedLong> m_inIn;
  Beside m_beside;
  coil::Mutex m_mutex;
  int m_turns;
};

int Beside::svc()
{
  coil::TimeMeasure measure;
  for (int i = 0; i < 3; i++)
    {
      measure.tick();
      m_owner->turn();
      coil::usleep(100);
      measure.tack();
    }
  return 0;
}

static const char* leaner_spec[] =
  {
    "implementation_id", "Leaner",
    "type_name",         "Leaner",
    "description",       "Leans on what comes along",
    "version",           "1.1.0",
    "vendor",            "peer",
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
  void LeanerInit(RTC::Manager* manager)
  {
    RTC::Properties profile(leaner_spec);
    manager->registerFactory(profile, RTC::Create<Leaner>, RTC::Delete<Leaner>);
  }
};

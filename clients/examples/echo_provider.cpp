// EchoProvider: offers the service Example::EchoService.
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <rtm/CorbaPort.h>

#include <deque>
#include <mutex>
#include <string>

#include "EchoSkel.h"

// Any thread: calls come from the ORB's threads.
class EchoServant : public virtual POA_Example::EchoService, public virtual PortableServer::RefCountServantBase {
 public:
  char* echo(const char* text) override {
    std::lock_guard lock(mutex_);
    texts_.emplace_back(text);
    if (texts_.size() > 100) texts_.pop_front();
    return CORBA::string_dup(text);
  }

  Example::Texts* history() override {
    std::lock_guard lock(mutex_);
    Example::Texts_var out = new Example::Texts;
    out->length(static_cast<CORBA::ULong>(texts_.size()));
    for (CORBA::ULong i = 0; i < out->length(); ++i) out[i] = CORBA::string_dup(texts_[i].c_str());
    return out._retn();
  }

 private:
  std::mutex mutex_;
  std::deque<std::string> texts_;
};

class EchoProvider : public RTC::DataFlowComponentBase {
 public:
  explicit EchoProvider(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}

  RTC::ReturnCode_t onInitialize() override {
    port_.registerProvider("echo0", "Example::EchoService", servant_);
    addPort(port_);
    return RTC::RTC_OK;
  }

 private:
  EchoServant servant_;
  RTC::CorbaPort port_{"Echo"};
};

// clang-format off
static const char* const echoprovider_spec[] = {
    "implementation_id", "EchoProvider",
    "type_name", "EchoProvider",
    "description", "Answers with the text that it is called with",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "example",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    ""};
// clang-format on

extern "C" {
DLL_EXPORT void EchoProviderInit(RTC::Manager* manager) {
  coil::Properties profile(echoprovider_spec);
  manager->registerFactory(profile, RTC::Create<EchoProvider>, RTC::Delete<EchoProvider>);
}
}

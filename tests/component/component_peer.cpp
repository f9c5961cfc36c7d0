// The other process of the component tests: a component with two data ports and an organization. Prints its reference, then works until it
// is stopped. It prints a line if a callback runs beside another one ("overlap") or after onFinalize ("late"). Values of its configuration
// set "default" that it reads in every callback: `held`, names of callbacks that print "held NAME" and wait until their name is no longer
// there; `asking`, names of those that set the rate of the execution context with handle 1000.
#include <omniORB4/CORBA.h>
#include <rtm/InPort.h>
#include <rtm/OutPort.h>
#include <rtm/SdoOrganization.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <thread>

#include "corba/orb/orb.h"
#include "support/component_fixture.h"
#include "support/usage.h"

namespace {

class PeerComponent : public support::ProbeComponent {
 public:
  PeerComponent() : support::ProbeComponent(nullptr, "Peer0"), in_("in", received_), out_("out", sent_) {
    during = [this](const std::string& callback) { look_at(callback); };
  }

  RTC::ReturnCode_t onInitialize() override {
    addInPort("in", in_);
    addOutPort("out", out_);
    RTC::RTObject_var self = getObjRef();
    auto* organization = new SDOPackage::Organization_impl(self);
    addOwnedOrganization(organization);
    organization->_remove_ref();
    return support::ProbeComponent::onInitialize();
  }

 private:
  static void print(const char* what, const std::string& callback) {
    std::printf("%s %s\n", what, callback.c_str());
    std::fflush(stdout);
  }
  bool is_named(const char* key, const std::string& callback) {
    return coil::includes(getConfigService().getConfigurationSet("default").getProperty(key), callback);
  }
  void look_at(const std::string& callback) {
    if (is_inside_.exchange(true)) print("overlap", callback);
    if (is_finalized_ && callback != "onShutdown") print("late", callback);
    if (callback == "onFinalize") is_finalized_ = true;
    if (is_named("held", callback)) {
      print("held", callback);
      const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
      while (is_named("held", callback) && std::chrono::steady_clock::now() < deadline)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    if (is_named("asking", callback)) setExecutionRate(1000, getExecutionRate(1000) + 1);
    std::this_thread::yield();  // others come, if they can
    is_inside_ = false;
  }

  std::atomic<bool> is_inside_{false};
  std::atomic<bool> is_finalized_{false};
  RTC::TimedLong received_{}, sent_{};
  RTC::InPort<RTC::TimedLong> in_;
  RTC::OutPort<RTC::TimedLong> out_;
};

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "component_peer\nIs the second process of component tests; runs until SIGTERM.");
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  auto orb = corba::Orb::start({.endpoints = {}, .arguments = {}});
  if (!orb) return std::fprintf(stderr, "%s\n", orb.error().message.c_str()), 1;
  (*orb)->activate();
  {
    support::Owned<PeerComponent> component;
    if (component->initialize() != RTC::RTC_OK) return 1;
    RTC::RTObject_var reference = component->getObjRef();
    const CORBA::String_var text = (*orb)->orb()->object_to_string(reference);
    std::printf("component %s\nready\n", text.in());
    std::fflush(stdout);
    int number = 0;
    sigwait(&stop, &number);
  }
  return 0;
}

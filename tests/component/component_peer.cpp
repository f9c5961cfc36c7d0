// The other process of the component tests: a component with two data ports and an organization. Prints its reference, then works until it
// is stopped.
#include <omniORB4/CORBA.h>
#include <rtm/InPort.h>
#include <rtm/OutPort.h>
#include <rtm/SdoOrganization.h>
#include <rtm/idl/BasicDataTypeSkel.h>

#include <csignal>
#include <cstdio>

#include "corba/orb/orb.h"
#include "support/component_fixture.h"

namespace {

class PeerComponent : public support::ProbeComponent {
 public:
  PeerComponent() : support::ProbeComponent(nullptr, "Peer0"), in_("in", received_), out_("out", sent_) {}

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
  RTC::TimedLong received_{}, sent_{};
  RTC::InPort<RTC::TimedLong> in_;
  RTC::OutPort<RTC::TimedLong> out_;
};

}  // namespace

int main() {
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

// The other process of the tests and benchmarks of ports: an InPort and an OutPort of octets, and a bare servant to compare with. Prints
// its references, then works until it is stopped.
#include <omniORB4/CORBA.h>
#include <rtm/InPort.h>
#include <rtm/OutPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/DataPort_OpenRTMSkel.h>

#include <csignal>
#include <cstdio>

#include "ports/support.h"

namespace {

class BareServant : public POA_OpenRTM::InPortCdr, public PortableServer::RefCountServantBase {
 public:
  OpenRTM::PortStatus put(const OpenRTM::CdrData&) override { return OpenRTM::PORT_OK; }
};

}  // namespace

int main(int argc, char** argv) {
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  corba::OrbSettings settings;
  settings.unix_socket = !(argc > 1 && std::string(argv[1]) == "--tcp");
  auto orb = corba::Orb::start(settings);
  if (!orb) return std::fprintf(stderr, "%s\n", orb.error().message.c_str()), 1;
  RTC::TimedOctetSeq received{};
  RTC::TimedOctetSeq sent{};
  RTC::InPort<RTC::TimedOctetSeq> in("Peer0.in", received);
  RTC::OutPort<RTC::TimedOctetSeq> out("Peer0.out", sent);
  ports::Local<BareServant> bare;
  const OpenRTM::InPortCdr_var bare_reference = bare._this();
  const auto show = [&](const char* name, CORBA::Object_ptr object) {
    const CORBA::String_var text = (*orb)->orb()->object_to_string(object);
    std::printf("%s %s\n", name, text.in());
  };
  show("in", in.getPortRef());
  show("out", out.getPortRef());
  show("bare", bare_reference);
  (*orb)->activate();
  std::printf("ready\n");
  std::fflush(stdout);
  int number = 0;
  sigwait(&stop, &number);
  return 0;
}

// The other process of the tests and benchmarks of ports: an InPort and an OutPort of octets, a service port that provides
// an Echo, and bare servants to compare with. Prints its references, then works until it is stopped.
//   ports_peer [--tcp] [--echo]    tcp only; the OutPort sends whatever the InPort receives
#include <omniORB4/CORBA.h>
#include <rtm/InPort.h>
#include <rtm/OutPort.h>
#include <rtm/idl/BasicDataTypeSkel.h>
#include <rtm/idl/DataPort_OpenRTMSkel.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <vector>

#include "ports/support.h"
#include "support/usage.h"

namespace {

class BareServant : public POA_OpenRTM::InPortCdr, public PortableServer::RefCountServantBase {
 public:
  OpenRTM::PortStatus put(const OpenRTM::CdrData&) override { return OpenRTM::PORT_OK; }
};

// Keeps what came last for somebody to look at, as a servant does whose samples are of use. For one caller at a time.
class KeepingServant : public POA_OpenRTM::InPortCdr, public PortableServer::RefCountServantBase {
 public:
  OpenRTM::PortStatus put(const OpenRTM::CdrData& sample) override {
    // What a careful author writes: the sequence's own assignment goes octet by octet.
    last_.assign(sample.get_buffer(), sample.get_buffer() + sample.length());
    return OpenRTM::PORT_OK;
  }

 private:
  std::vector<CORBA::Octet> last_;
};

}  // namespace

int main(int argc, char** argv) {
  ::test::answer_help(argc, argv, "ports_peer [--tcp]\nIs the second process of port tests; runs until SIGTERM.");
  sigset_t stop;
  sigemptyset(&stop);
  sigaddset(&stop, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &stop, nullptr);
  corba::OrbSettings settings;
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const auto is_given = [&](const char* name) { return std::ranges::find(arguments, name) != arguments.end(); };
  settings.unix_socket = !is_given("--tcp");
  settings.peer_check_interval = std::chrono::milliseconds(200);
  auto orb = corba::Orb::start(settings);
  if (!orb) return std::fprintf(stderr, "%s\n", orb.error().message.c_str()), 1;
  RTC::TimedOctetSeq received{};
  RTC::TimedOctetSeq sent{};
  RTC::InPort<RTC::TimedOctetSeq> in("Peer0.in", received);
  RTC::OutPort<RTC::TimedOctetSeq> out("Peer0.out", sent);
  ports::Local<BareServant> bare;
  const OpenRTM::InPortCdr_var bare_reference = bare._this();
  ports::Local<KeepingServant> keeping;
  const OpenRTM::InPortCdr_var keeping_reference = keeping._this();
  const auto show = [&](const char* name, CORBA::Object_ptr object) {
    const CORBA::String_var text = (*orb)->orb()->object_to_string(object);
    std::printf("%s %s\n", name, text.in());
  };
  show("in", in.getPortRef());
  show("out", out.getPortRef());
  show("bare", bare_reference);
  show("keeping", keeping_reference);
  ports::Local<BareServant> echo;
  RTC::CorbaPort service("Peer0.service");
  service.registerProvider("echo0", "Echo", echo);
  service.activateInterfaces();
  show("service", service.getPortRef());
  (*orb)->activate();
  std::printf("ready\n");
  std::fflush(stdout);
  const bool is_echo = is_given("--echo");
  const timespec pause{is_echo ? 0 : 1, is_echo ? 1'000'000 : 0};  // pull connections have to be asked
  while (sigtimedwait(&stop, nullptr, &pause) != SIGTERM) {
    while (is_echo && in.isNew() && in.read()) out.write(received);
  }
  return 0;
}

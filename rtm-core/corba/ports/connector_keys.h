// The keys of a ConnectorProfile that contain the object of a data port. Any thread.
#pragma once

#include <optional>

#include "corba/orb/principal.h"
#include "corba/transport/transport.h"
#include "core/connector_settings.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

// Writes <interface>.<side>port_ior and _ref, replacing what somebody has left there.
void publish_reference(RTC::ConnectorProfile& profile, rt::Interface interface, rt::Side provider_side, const Provider& provider);
// The object of the other side: the last _ior that can be read, else _ref; nil if there is neither.
CORBA::Object_ptr published_reference(const RTC::ConnectorProfile& profile, rt::Interface interface, rt::Side provider_side);
// The object that a peer has named; nil if the text is no reference. Only IOR: and corbaloc: count, since other forms, as corbaname, ask
// servers that the sender of the text chooses.
CORBA::Object_ptr parse_reference(const char* text);
// Takes out references that an earlier life of this connection has left in the profile.
void remove_references(RTC::ConnectorProfile& profile);
// The time-out, byte order and sizes of a connection.
Line line_of(const rt::ConnectorSettings& settings);

// The thread works for the stranger who gave one of these ports, if one did: they answer with references of their choice.
class OnBehalfOfSenders {
 public:
  explicit OnBehalfOfSenders(const RTC::PortServiceList& ports);

 private:
  std::optional<OnBehalfOf> principal_;
};

// Whether the ports of a profile but for the one in that place may be kept (corba/orb/principal.h): they are watched, connected again, told
// of the end.
bool may_keep_ports(const RTC::PortServiceList& ports, int self);

}  // namespace corba

#include "corba/ports/connector_keys.h"

#include <algorithm>
#include <string>

#include "base/text.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/nv_list.h"
#include "corba/orb/principal.h"

namespace corba {
namespace {

// shared_memory uses the keys of corba_cdr.
std::string prefix_of(rt::Interface interface, rt::Side side) {
  return std::string("dataport.") + (interface == rt::Interface::data_service ? "data_service" : "corba_cdr") +
         (side == rt::Side::in ? ".inport" : ".outport");
}

}  // namespace

CORBA::Object_ptr parse_reference(const char* text) {
  const auto form = base::to_lower(text);
  if (!form.starts_with("ior:") && !form.starts_with("corbaloc:")) return CORBA::Object::_nil();
  // "resolve initial reference": an object of this ORB itself, on which no call can be made.
  if (form.starts_with("corbaloc:") && form.find("rir:") != std::string::npos) return CORBA::Object::_nil();
  try {
    return orb()->string_to_object(text);
  } catch (const CORBA::Exception&) {
    return CORBA::Object::_nil();
  }
}

void publish_reference(RTC::ConnectorProfile& profile, rt::Interface interface, rt::Side side, const Provider& provider) {
  const std::string prefix = prefix_of(interface, side);
  const CORBA::String_var text = orb()->object_to_string(provider.reference());
  set_text(profile.properties, prefix + "_ior", text.in());
  set_value(profile.properties, prefix + "_ref", provider.as_any());
}

CORBA::Object_ptr published_reference(const RTC::ConnectorProfile& profile, rt::Interface interface, rt::Side side) {
  const std::string prefix = prefix_of(interface, side);
  // A peer that adds without replacing leaves the stale entry in front of its own.
  for (CORBA::ULong i = profile.properties.length(); i-- > 0;) {
    const auto& entry = profile.properties[i];
    const char* text = nullptr;
    if (prefix + "_ior" != entry.name.in() || !(entry.value >>= text)) continue;
    CORBA::Object_var object = parse_reference(text);
    if (!CORBA::is_nil(object)) return may_keep(object) ? object._retn() : CORBA::Object::_nil();
  }
  for (CORBA::ULong i = profile.properties.length(); i-- > 0;) {
    const auto& entry = profile.properties[i];
    CORBA::Object_var object;
    if (prefix + "_ref" != entry.name.in() || !(entry.value >>= CORBA::Any::to_object(object.out()))) continue;
    if (!CORBA::is_nil(object)) return may_keep(object) ? object._retn() : CORBA::Object::_nil();
  }
  return CORBA::Object::_nil();
}

void remove_references(RTC::ConnectorProfile& profile) {
  RTC::NVList kept;
  kept.length(profile.properties.length());
  CORBA::ULong count = 0;
  for (CORBA::ULong i = 0; i < profile.properties.length(); ++i) {
    bool is_stale = false;
    for (const auto interface : {rt::Interface::corba_cdr, rt::Interface::data_service}) {
      for (const auto side : {rt::Side::in, rt::Side::out}) {
        const std::string prefix = prefix_of(interface, side);
        is_stale |= prefix + "_ior" == profile.properties[i].name.in() || prefix + "_ref" == profile.properties[i].name.in();
      }
    }
    if (!is_stale) kept[count++] = profile.properties[i];
  }
  kept.length(count);
  profile.properties = kept;
}

// A peer may ask for a longer timeout than calls have here, but not without end.
Line line_of(const rt::ConnectorSettings& settings) {
  constexpr std::chrono::milliseconds most{60'000};
  const auto usual = port_call_timeout();
  return {settings.order, std::min(settings.call_timeout.value_or(usual), std::max(usual, most)), settings.shared_memory_size};
}

OnBehalfOfSenders::OnBehalfOfSenders(const RTC::PortServiceList& ports) {
  if (principal() != Principal::own) return;
  for (CORBA::ULong i = 0; i < ports.length() && !principal_; ++i) {
    if (const Principal sender = sender_of(ports[i].in()); sender != Principal::own) principal_.emplace(sender);
  }
}

bool may_keep_ports(const RTC::PortServiceList& ports, int self) {
  const ChainDeadline deadline(std::chrono::milliseconds(700));  // 2 s for all
  for (CORBA::ULong i = 0; i < ports.length(); ++i) {
    if (i != static_cast<CORBA::ULong>(self) && !may_keep(ports[i], deadline.left())) return false;
  }
  return true;
}

}  // namespace corba

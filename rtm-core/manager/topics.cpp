// Ports that find each other by a topic: data ports by publish_topic (out) and subscribe_topic (in), service ports by rendezvous_point, all
// properties of the port. Bound as dataports.port_cxt/<topic>.topic_cxt/<port>.outport (.inport) and svcports.port_cxt/<point>.svc_cxt/
// <port>.svc; looked for in this process, in the naming services, and at the managers of naming.type manager.
#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "corba/orb/orb.h"
#include "core/name_format.h"
#include "manager/manager_impl.h"
#include "rtm/CORBA_RTCUtil.h"
#include "rtm/NVUtil.h"
#include "rtm/NamingManager.h"
#include "rtm/PortBase.h"

namespace RTC {
namespace {

struct Topic {
  std::string context;
  std::string kind;    // of the port
  std::string wanted;  // of those it is connected with
};

constexpr std::size_t max_topics = 64;  // of a port; each is a name in naming services, and is looked for at every component

// A port may have several topics, separated by commas; most have none. What is too much is left out.
std::vector<Topic> topics_of(const PortProfile& profile, std::size_t most = max_topics) {
  struct Rule {
    const char* port_type;
    const char* property;
    const char* folder;
    const char* context_kind;
    const char* kind;
    const char* wanted;
  };
  static constexpr Rule rules[] = {{"DataOutPort", "publish_topic", "dataports.port_cxt/", ".topic_cxt", "outport", "inport"},
                                   {"DataInPort", "subscribe_topic", "dataports.port_cxt/", ".topic_cxt", "inport", "outport"},
                                   {"CorbaPort", "rendezvous_point", "svcports.port_cxt/", ".svc_cxt", "svc", "svc"}};
  std::vector<Topic> topics;
  const auto type = NVUtil::toString(profile.properties, "port.port_type");
  for (const auto& rule : rules) {
    if (type != rule.port_type) continue;
    for (const auto& name : base::split_list(NVUtil::toString(profile.properties, rule.property))) {
      if (topics.size() == most) return topics;
      topics.push_back({rule.folder + rt::escape_name(name) + rule.context_kind, rule.kind, rule.wanted});
    }
  }
  return topics;
}

// Somebody offers what the other one wants.
bool fit(const PortProfile& a, const PortProfile& b) {
  if (NVUtil::toString(a.properties, "port.port_type") != "CorbaPort") return true;
  for (CORBA::ULong i = 0; i < a.interfaces.length(); ++i) {
    for (CORBA::ULong k = 0; k < b.interfaces.length(); ++k) {
      const bool is_same = std::string_view(a.interfaces[i].type_name.in()) == b.interfaces[k].type_name.in();
      if (is_same && a.interfaces[i].polarity != b.interfaces[k].polarity) return true;
    }
  }
  return false;
}

// Two processes that start at once may both have made the connection: of several between the two ports the one with the least id stays,
// on whichever side that is noticed.
void keep_one(PortService_ptr port, PortService_ptr other, const std::string& name) {
  ConnectorProfileList_var profiles = port->get_connector_profiles();
  std::vector<std::string> ids;
  for (CORBA::ULong i = 0; i < profiles->length(); ++i) {
    const auto& ports = profiles[i].ports;
    const bool is_between = ports.length() == 2 && (ports[0]->_is_equivalent(other) || ports[1]->_is_equivalent(other));
    if (is_between && name == profiles[i].name.in()) ids.emplace_back(profiles[i].connector_id.in());
  }
  std::sort(ids.begin(), ids.end());
  for (std::size_t i = 1; i < ids.size(); ++i) port->disconnect(ids[i].c_str());
}

void connect_by_topic(PortService_ptr port, const PortProfile& profile, CORBA::Object_ptr candidate) {
  try {
    PortService_var other = PortService::_narrow(candidate);
    if (CORBA::is_nil(other) || other->_is_equivalent(port) || CORBA_RTCUtil::already_connected(port, other)) return;
    PortProfile_var theirs = other->get_port_profile();
    if (!fit(profile, theirs)) return;
    const bool is_first = std::string_view(profile.name.in()) < theirs->name.in();
    const auto name =
        std::string(is_first ? profile.name.in() : theirs->name.in()) + ":" + (is_first ? theirs->name.in() : profile.name.in());
    const auto code = CORBA_RTCUtil::connect(name, coil::Properties(), port, other);
    if (code != RTC_OK) {
      base::log(base::Level::warn, "manager", "ports {} have a topic in common, but reject the connection, code {}", name,
                static_cast<int>(code));
      return;
    }
    keep_one(port, other, name);
  } catch (const CORBA::Exception& e) {  // an entry of something dead
    base::log(base::Level::debug, "manager", "port {}: another one of its topic does not answer: {}", profile.name.in(), corba::to_text(e));
  }
}

// Calls function(port, profile, topic) for the ports of the component that have topics.
template <class Function>
void for_each_topic(RTObject_ptr component, Function function) {
  try {
    PortServiceList_var ports = component->get_ports();
    for (CORBA::ULong i = 0; i < ports->length(); ++i) {
      PortProfile_var profile = ports[i]->get_port_profile();
      for (const auto& topic : topics_of(profile)) function(ports[i], profile.in(), topic);
    }
  } catch (const CORBA::Exception& e) {  // it has gone
    base::log(base::Level::debug, "manager", "the ports of a component are unknown: {}", corba::to_text(e));
  }
}

}  // namespace

void ManagerImpl::publish_ports(const Managed& component) {
  std::vector<std::string> names;
  for (auto* port : component.ports()) {
    const PortProfile profile = port->getPortProfile();
    auto topics = topics_of(profile, max_topics + 1);
    if (topics.size() > max_topics) {
      topics.pop_back();
      RTC_ERROR(("port %s: has more than %zu topics: the others are left out", profile.name.in(), max_topics));
    }
    for (const auto& topic : topics) {
      names.push_back(topic.context + "/" + rt::escape_name(profile.name.in()) + "." + topic.kind);
      naming->bindPortObject(names.back().c_str(), port->getPortRef());
    }
  }
  auto locked = state.lock();
  for (auto& [id, record] : locked->records) {
    if (record.component == component.object()) record.port_names = names;
  }
}

void ManagerImpl::subscribe_ports(const Managed& component) {
  for (auto* port : component.ports()) {
    const PortProfile profile = port->getPortProfile();
    for (const auto& topic : topics_of(profile)) {
      const auto connect_ports_of = [&](RTObject_ptr other) {
        for_each_topic(other, [&](PortService_ptr candidate, const PortProfile&, const Topic& theirs) {
          if (theirs.context == topic.context && theirs.kind == topic.wanted) connect_by_topic(port->getPortRef(), profile, candidate);
        });
      };
      for (const auto& local : held_components()) {
        RTObject_var reference = local->reference();
        if (!CORBA::is_nil(reference)) connect_ports_of(reference);
      }
      for (const auto& candidate : naming->list(topic.context, topic.wanted)) connect_by_topic(port->getPortRef(), profile, candidate);
      const RTCList others = naming->componentsOfManagers();
      for (CORBA::ULong i = 0; i < others.length(); ++i) connect_ports_of(RTObject_var(RTObject::_duplicate(others[i])));
    }
  }
}

void Manager::publishPorts(RTObject_impl* comp) {
  if (const auto component = impl_->held_component(comp); component && impl_->naming) impl_->publish_ports(*component);
}

void Manager::subscribePorts(RTObject_impl* comp) {
  if (const auto component = impl_->held_component(comp); component && impl_->naming) impl_->subscribe_ports(*component);
}

}  // namespace RTC

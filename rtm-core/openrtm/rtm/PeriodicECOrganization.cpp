#include <rtm/PeriodicECOrganization.h>
#include <rtm/RTObject.h>

#include "base/log.h"
#include "base/text.h"
#include "corba/orb.h"

namespace SDOPackage {

namespace {

constexpr const char* speaker = "composite";

// Calls another component; what it throws is one log line.
template <class Function>
bool attempt(const std::string& id, const char* what, Function function) {
  try {
    function();
    return true;
  } catch (const CORBA::Exception& exception) {
    base::log(base::Level::warn, speaker, "member {} does not {}: {}", id, what, corba::to_text(exception));
  }
  return false;
}

RTC::ExecutionContext_ptr own_context(RTC::RTObject_impl& composite) { return composite.getExecutionContext(0); }

}  // namespace

PeriodicECOrganization::PeriodicECOrganization(RTC::RTObject_impl& composite)
    : Organization_impl(RTC::RTObject_var(composite.getObjRef())), composite_(composite) {}

bool PeriodicECOrganization::join(const Member& member) {
  SDO_var sdo = member.sdo;
  RTC::LightweightRTObject_var component;
  const bool joined = attempt(member.id, "join", [&] {
    component = RTC::LightweightRTObject::_narrow(sdo);
    if (CORBA::is_nil(component)) return;
    RTC::ExecutionContextList_var contexts = component->get_owned_contexts();
    for (CORBA::ULong i = 0; i < contexts->length(); ++i) contexts[i]->stop();
    Configuration_var configuration = sdo->get_configuration();
    Organization_var self = getObjRef();
    configuration->add_organization(self);
    RTC::ExecutionContext_var context = own_context(composite_);
    if (!CORBA::is_nil(context)) context->add_component(component);
    // A composite inside a composite: its members run here, too.
    OrganizationList_var inner = sdo->get_owned_organizations();
    for (CORBA::ULong i = 0; i < inner->length(); ++i) {
      SDOList_var sdos = inner[i]->get_members();
      for (CORBA::ULong k = 0; k < sdos->length(); ++k) {
        RTC::LightweightRTObject_var innermost = RTC::LightweightRTObject::_narrow(sdos[k]);
        if (!CORBA::is_nil(innermost) && !CORBA::is_nil(context)) context->add_component(innermost);
      }
    }
  });
  return joined && !CORBA::is_nil(component);
}

void PeriodicECOrganization::leave(const Member& member) {
  SDO_var sdo = member.sdo;
  attempt(member.id, "leave", [&] {
    RTC::LightweightRTObject_var component = RTC::LightweightRTObject::_narrow(sdo);
    if (CORBA::is_nil(component)) return;
    RTC::ExecutionContext_var context = own_context(composite_);
    if (!CORBA::is_nil(context)) {
      if (context->get_component_state(component) == RTC::ACTIVE_STATE) context->deactivate_component(component);
      context->remove_component(component);
    }
    Configuration_var configuration = sdo->get_configuration();
    CORBA::String_var id = get_organization_id();
    configuration->remove_organization(id);
    RTC::ExecutionContextList_var contexts = component->get_owned_contexts();
    for (CORBA::ULong i = 0; i < contexts->length(); ++i) contexts[i]->start();
  });
}

CORBA::Boolean PeriodicECOrganization::add_members(const SDOList& sdo_list) {
  const std::vector<Member> joining = ask(sdo_list);
  bool all = true;
  turns_.take([&] {
    if (closed_) return;
    for (const Member& member : joining) {
      if (join(member))
        appendMembers({member});
      else
        all = false;
    }
    update_ports();
  });
  return all;
}

CORBA::Boolean PeriodicECOrganization::set_members(const SDOList& sdos) {
  const std::vector<Member> joining = ask(sdos);
  turns_.take([&] {
    for (const Member& member : replaceMembers({})) leave(member);
  });
  return joining.empty() || add_members(sdos);
}

CORBA::Boolean PeriodicECOrganization::remove_member(const char* id) {
  if (id[0] == '\0') throw InvalidParameter("the id is empty");
  bool found = false;
  turns_.take([&] {
    Member member;
    if (!takeMember(id, member)) return;
    found = true;
    leave(member);
    update_ports();
  });
  if (!found) throw InvalidParameter(("no member " + base::in_quotes(id)).c_str());
  return true;
}

void PeriodicECOrganization::export_ports(const std::string& list) {
  turns_.take([&] {
    wanted_ports_.clear();
    for (std::string& name : base::split_list(list)) wanted_ports_.insert(std::move(name));
    update_ports();
  });
}

void PeriodicECOrganization::update_ports() {
  std::map<std::string, RTC::PortService_var> wanted;
  for_each_member([&](const Member& member, RTC::RTObject_ptr component) {
    RTC::PortServiceList_var ports = component->get_ports();
    for (CORBA::ULong i = 0; i < ports->length(); ++i) {
      RTC::PortProfile_var profile = ports[i]->get_port_profile();
      const std::string name = profile->name.in();
      if (wanted_ports_.count(name) != 0 || wanted_ports_.count(member.id + "." + name) != 0)
        wanted[name] = RTC::PortService::_duplicate(ports[i]);
    }
  });
  for (auto it = exported_.begin(); it != exported_.end();) {
    if (wanted.count(it->first) == 0) {
      composite_.removePort(it->second);
      it = exported_.erase(it);
    } else {
      ++it;
    }
  }
  for (const auto& [name, port] : wanted)
    if (exported_.count(name) == 0 && composite_.addPort(RTC::PortService_var(port))) exported_.emplace(name, port);
}

template <class Function>
void PeriodicECOrganization::for_each_member(Function function) {
  for (const Member& member : members()) {
    SDO_var sdo = member.sdo;
    attempt(member.id, "answer", [&] {
      RTC::RTObject_var component = RTC::RTObject::_narrow(sdo);
      if (!CORBA::is_nil(component)) function(member, component.in());
    });
  }
}

void PeriodicECOrganization::activate_members() {
  RTC::ExecutionContext_var context = own_context(composite_);
  for_each_member([&](const Member&, RTC::RTObject_ptr component) { context->activate_component(component); });
}

void PeriodicECOrganization::deactivate_members() {
  RTC::ExecutionContext_var context = own_context(composite_);
  for_each_member([&](const Member&, RTC::RTObject_ptr component) { context->deactivate_component(component); });
}

void PeriodicECOrganization::reset_members() {
  RTC::ExecutionContext_var context = own_context(composite_);
  for_each_member([&](const Member&, RTC::RTObject_ptr component) {
    if (context->get_component_state(component) == RTC::ERROR_STATE) context->reset_component(component);
  });
}

void PeriodicECOrganization::close() {
  turns_.take([&] {
    closed_ = true;
    wanted_ports_.clear();
    for (const auto& [name, port] : exported_) composite_.removePort(RTC::PortService_var(port));
    exported_.clear();
    for (const Member& member : replaceMembers({})) leave(member);
  });
}

}  // namespace SDOPackage

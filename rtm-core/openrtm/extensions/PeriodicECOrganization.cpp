#include <rtm/PeriodicECOrganization.h>
#include <rtm/RTObject.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <optional>

#include "base/log.h"
#include "base/text.h"
#include "corba/members/remote_participant.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/orb.h"
#include "corba/orb/principal.h"
#include "core/workers.h"

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

// One deadline for what is asked of one member: it says itself how many contexts, ports and members it has.
class ShortCalls {
 public:
  // The object, which is asked next; throws when the time is over.
  template <class Reference>
  auto* operator()(const Reference& reference) const {
    check();
    auto* const object = reference.operator->();
    deadline_.limit(object);
    return object;
  }
  void check() const {
    if (deadline_.is_over()) throw CORBA::TIMEOUT(0, CORBA::COMPLETED_NO);
  }

 private:
  corba::ChainDeadline deadline_{corba::port_call_timeout()};
};

RTC::ExecutionContext_ptr own_context(RTC::RTObject_impl& composite) { return composite.getExecutionContext(0); }

// Looks for one organization among components, their members, the members of these, and so on. Holds no lock.
class MemberSearch {
 public:
  static constexpr std::chrono::milliseconds answer_time{1000};  // of each that is asked; who does not answer has no members
  static constexpr std::chrono::seconds whole_time{5};

  explicit MemberSearch(const std::string& organization) : wanted_(organization) {}

  void add(SDO_ptr sdo) { waiting_.push_back(SDO::_duplicate(sdo)); }
  // Why these components cannot be members of that organization; nothing when they can.
  std::optional<std::string> complain() {
    for (; !waiting_.empty() && !is_found_ && !is_late(); waiting_.pop_front()) {
      try {
        look_into(waiting_.front());
      } catch (const CORBA::Exception& exception) {
        base::log(base::Level::debug, speaker, "a member of a member does not answer: {}", corba::to_text(exception));
      }
    }
    if (is_found_) return "the composite would be a member of itself";
    if (!waiting_.empty()) return "it takes too long to find out what the members of the members are";
    return std::nullopt;
  }
  bool has_met_composites() const { return !seen_.empty(); }

 private:
  void look_into(SDO_ptr component) {
    const SDO_var sdo = corba::copy_as<SDO>(component, answer_time);
    OrganizationList_var organizations = sdo->get_owned_organizations();
    for (CORBA::ULong i = 0; i < organizations->length() && !is_found_ && !is_late(); ++i) {
      const Organization_var organization = corba::copy_as<Organization>(organizations[i], answer_time);
      if (CORBA::is_nil(organization)) continue;
      CORBA::String_var id = organization->get_organization_id();
      is_found_ = id.in() == wanted_;
      if (is_found_ || !seen_.insert(id.in()).second) continue;
      SDOList_var members = organization->get_members();
      for (CORBA::ULong k = 0; k < members->length(); ++k)
        if (!CORBA::is_nil(members[k])) add(members[k]);
    }
  }
  bool is_late() const { return std::chrono::steady_clock::now() > deadline_; }

  const std::string wanted_;
  const std::chrono::steady_clock::time_point deadline_ = std::chrono::steady_clock::now() + whole_time;
  std::deque<SDO_var> waiting_;
  std::set<std::string> seen_;
  bool is_found_ = false;
};

}  // namespace

class PeriodicECOrganization::Turns final : public rt::CallSerializer {};

PeriodicECOrganization::PeriodicECOrganization(RTC::RTObject_impl& composite)
    : Organization_impl(RTC::RTObject_var(composite.getObjRef())), composite_(composite), turns_(std::make_unique<Turns>()) {}

PeriodicECOrganization::~PeriodicECOrganization() = default;

bool PeriodicECOrganization::join(const Member& member) {
  SDO_var sdo = member.sdo;
  if (!corba::may_keep(sdo)) return false;
  RTC::LightweightRTObject_var component;
  const ShortCalls in_time;
  const bool joined = attempt(member.id, "join", [&] {
    component = RTC::LightweightRTObject::_narrow(sdo);
    if (CORBA::is_nil(component)) return;
    RTC::ExecutionContextList_var contexts = component->get_owned_contexts();
    for (CORBA::ULong i = 0; i < contexts->length(); ++i) in_time(contexts[i])->stop();
    Configuration_var configuration = sdo->get_configuration();
    Organization_var self = getObjRef();
    if (!CORBA::is_nil(configuration)) configuration->add_organization(self);
    RTC::ExecutionContext_var context = own_context(composite_);
    if (!CORBA::is_nil(context)) context->add_component(component);
    // A composite inside a composite: its members run here, too.
    OrganizationList_var inner = sdo->get_owned_organizations();
    for (CORBA::ULong i = 0; i < inner->length(); ++i) {
      SDOList_var sdos = in_time(inner[i])->get_members();
      for (CORBA::ULong k = 0; k < sdos->length(); ++k) {
        in_time.check();
        RTC::LightweightRTObject_var innermost = RTC::LightweightRTObject::_narrow(sdos[k]);
        if (!CORBA::is_nil(innermost) && !CORBA::is_nil(context)) context->add_component(innermost);
      }
    }
  });
  return joined && !CORBA::is_nil(component);
}

void PeriodicECOrganization::leave(const Member& member) {
  SDO_var sdo = member.sdo;
  const corba::OnBehalfOfSender sender(sdo);  // its contexts are what it says
  const ShortCalls in_time;
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
    if (!CORBA::is_nil(configuration)) configuration->remove_organization(id);
    RTC::ExecutionContextList_var contexts = component->get_owned_contexts();
    for (CORBA::ULong i = 0; i < contexts->length(); ++i) in_time(contexts[i])->start();
  });
}

CORBA::Boolean PeriodicECOrganization::add_members(const SDOList& sdo_list) { return take_in(ask(sdo_list), false); }

CORBA::Boolean PeriodicECOrganization::set_members(const SDOList& sdos) { return take_in(ask(sdos), true); }

bool PeriodicECOrganization::take_in(const std::vector<Member>& joining, bool others_leave) {
  CORBA::String_var id = get_organization_id();
  const auto search = [&](bool& has_met_composites) {
    MemberSearch members(id.in());
    for (const Member& member : joining) members.add(member.sdo);
    auto complaint = members.complain();
    has_met_composites = members.has_met_composites();
    return complaint;
  };
  bool has_composites = false;
  std::optional<std::string> complaint = search(has_composites);  // nobody has to wait for that
  if (complaint) throw InvalidParameter(complaint->c_str());

  const auto is_one_of = [](const std::vector<Member>& list, const Member& member) {
    return std::any_of(list.begin(), list.end(), [&](const Member& other) { return other.id == member.id; });
  };
  bool all = true;
  turns_->take([&] {
    if (closed_) return;
    const std::vector<Member> before = members();
    appendMembers(joining);
    // Of two composites that take each other at the same time, both have told now what they want: at least one of them sees it.
    if (has_composites) complaint = search(has_composites);
    if (complaint) {
      replaceMembers(before);
      return;
    }
    if (others_leave) {
      Member old;
      for (const Member& member : before)
        if (!is_one_of(joining, member)) takeMember(member.id, old);
      for (const Member& member : before) leave(member);
    }
    for (const Member& member : joining) {
      if (join(member)) continue;
      all = false;
      Member failed;
      if (others_leave || !is_one_of(before, member)) takeMember(member.id, failed);
    }
    update_ports();
  });
  if (complaint) throw InvalidParameter(complaint->c_str());
  return all;
}

CORBA::Boolean PeriodicECOrganization::remove_member(const char* id) {
  if (id[0] == '\0') throw InvalidParameter("the id is empty");
  bool found = false;
  turns_->take([&] {
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
  turns_->take([&] {
    wanted_ports_.clear();
    for (std::string& name : base::split_list(list)) wanted_ports_.insert(std::move(name));
    update_ports();
  });
}

void PeriodicECOrganization::update_ports() {
  std::map<std::string, RTC::PortService_var> wanted;
  for_each_member([&](const Member& member, RTC::RTObject_ptr component) {
    const ShortCalls in_time;
    RTC::PortServiceList_var ports = component->get_ports();
    for (CORBA::ULong i = 0; i < ports->length(); ++i) {
      RTC::PortProfile_var profile = in_time(ports[i])->get_port_profile();
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
    const corba::OnBehalfOfSender sender(sdo);
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
  turns_->take([&] {
    closed_ = true;
    wanted_ports_.clear();
    for (const auto& [name, port] : exported_) composite_.removePort(RTC::PortService_var(port));
    exported_.clear();
    for (const Member& member : replaceMembers({})) leave(member);
  });
}

}  // namespace SDOPackage

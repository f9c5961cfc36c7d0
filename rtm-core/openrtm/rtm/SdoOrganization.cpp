#include "rtm/SdoOrganization.h"

#include <rtm/NVUtil.h>

#include <algorithm>

#include "base/guarded.h"
#include "base/id.h"
#include "base/text.h"
#include "corba/orb/call_timeout.h"
#include "corba/orb/orb.h"
#include "core/key_limits.h"

namespace SDOPackage {

using namespace std::chrono_literals;

struct Organization_impl::Shared {
  struct Data {
    std::vector<Member> members{};
    SDOSystemElement_var owner{};
    OrganizationProperty property{};
    DependencyType dependency = OWN;
  };
  base::Guarded<Data, base::Rank::component> data;
};

Organization_impl::Organization_impl(SDOSystemElement_ptr owner) : id_(base::make_uuid()), shared_(std::make_unique<Shared>()) {
  shared_->data.lock()->owner = SDOSystemElement::_duplicate(owner);
}

Organization_impl::~Organization_impl() = default;

std::vector<Organization_impl::Member> Organization_impl::members() const { return shared_->data.lock()->members; }

Organization_ptr Organization_impl::getObjRef() { return _this(); }

char* Organization_impl::get_organization_id() { return CORBA::string_dup(id_.c_str()); }

OrganizationProperty* Organization_impl::get_organization_property() { return new OrganizationProperty(shared_->data.lock()->property); }

CORBA::Any* Organization_impl::get_organization_property_value(const char* name) {
  if (name[0] == '\0') throw InvalidParameter("the name is empty");
  {
    auto data = shared_->data.lock();
    const CORBA::Long index = NVUtil::find_index(data->property.properties, name);
    if (index >= 0) return new CORBA::Any(data->property.properties[static_cast<CORBA::ULong>(index)].value);
  }
  throw InvalidParameter(("no organization property " + base::in_quotes(name)).c_str());
}

CORBA::Boolean Organization_impl::add_organization_property(const OrganizationProperty& property) {
  shared_->data.lock()->property = property;
  return true;
}

CORBA::Boolean Organization_impl::set_organization_property_value(const char* name, const CORBA::Any& value) {
  if (name[0] == '\0') throw InvalidParameter("the name is empty");
  auto data = shared_->data.lock();
  NVList& list = data->property.properties;
  if (NVUtil::find_index(list, name) < 0 && list.length() >= rt::entry_limits.organization_properties)
    throw InvalidParameter(("the organization has as many properties as it may, " + std::to_string(list.length())).c_str());
  NVUtil::setValue(list, name, value);
  return true;
}

CORBA::Boolean Organization_impl::remove_organization_property(const char* name) {
  if (name[0] == '\0') throw InvalidParameter("the name is empty");
  auto data = shared_->data.lock();
  NVList& list = data->property.properties;
  const CORBA::Long index = NVUtil::find_index(list, name);
  if (index < 0) throw InvalidParameter("no such organization property");
  for (CORBA::ULong i = static_cast<CORBA::ULong>(index); i + 1 < list.length(); ++i) list[i] = list[i + 1];
  list.length(list.length() - 1);
  return true;
}

SDOSystemElement_ptr Organization_impl::get_owner() { return SDOSystemElement::_duplicate(shared_->data.lock()->owner); }

CORBA::Boolean Organization_impl::set_owner(SDOSystemElement_ptr sdo) {
  if (CORBA::is_nil(sdo)) throw InvalidParameter("the owner is nil");
  shared_->data.lock()->owner = SDOSystemElement::_duplicate(sdo);
  return true;
}

SDOList* Organization_impl::get_members() {
  const std::vector<Member> list = members();
  SDOList_var sdos = new SDOList();
  sdos->length(static_cast<CORBA::ULong>(list.size()));
  for (CORBA::ULong i = 0; i < sdos->length(); ++i) sdos[i] = SDO::_duplicate(list[i].sdo);
  return sdos._retn();
}

static void check_number(std::size_t members) {
  if (members > rt::entry_limits.members)
    throw InvalidParameter(("an organization has at most " + std::to_string(rt::entry_limits.members) + " members").c_str());
}

std::vector<Organization_impl::Member> Organization_impl::ask(const SDOList& sdos) {
  check_number(sdos.length());
  std::vector<Member> members;
  const corba::ChainDeadline deadline(corba::port_call_timeout());
  for (CORBA::ULong i = 0; i < sdos.length(); ++i) {
    if (CORBA::is_nil(sdos[i])) throw InvalidParameter("a member is nil");
    try {
      deadline.limit(sdos[i]);
      CORBA::String_var id = sdos[i]->get_sdo_id();
      members.push_back({id.in(), SDO::_duplicate(sdos[i])});
    } catch (const CORBA::Exception& exception) {
      throw InvalidParameter(("a member does not answer: " + corba::to_text(exception)).c_str());
    }
  }
  return members;
}

std::vector<Organization_impl::Member> Organization_impl::replaceMembers(std::vector<Member> members) {
  return std::exchange(shared_->data.lock()->members, std::move(members));
}

void Organization_impl::appendMembers(const std::vector<Member>& members) {
  auto data = shared_->data.lock();
  check_number(members.size() + data->members.size());
  for (const Member& member : members) {
    std::erase_if(data->members, [&](const Member& known) { return known.id == member.id; });
    data->members.push_back(member);
  }
}

bool Organization_impl::takeMember(const std::string& id, Member& member) {
  auto data = shared_->data.lock();
  const auto it = std::find_if(data->members.begin(), data->members.end(), [&](const Member& known) { return known.id == id; });
  if (it == data->members.end()) return false;
  member = *it;
  data->members.erase(it);
  return true;
}

CORBA::Boolean Organization_impl::set_members(const SDOList& sdos) {
  replaceMembers(ask(sdos));
  return true;
}

CORBA::Boolean Organization_impl::add_members(const SDOList& sdo_list) {
  appendMembers(ask(sdo_list));
  return true;
}

CORBA::Boolean Organization_impl::remove_member(const char* id) {
  if (id[0] == '\0') throw InvalidParameter("the id is empty");
  Member member;
  if (!takeMember(id, member)) throw InvalidParameter(("no member " + base::in_quotes(id)).c_str());
  return true;
}

DependencyType Organization_impl::get_dependency() { return shared_->data.lock()->dependency; }

CORBA::Boolean Organization_impl::set_dependency(DependencyType dependency) {
  shared_->data.lock()->dependency = dependency;
  return true;
}

}  // namespace SDOPackage

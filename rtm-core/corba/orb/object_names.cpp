#include "corba/orb/object_names.h"

#include <omniORB4/omniIOR.h>

#include <map>
#include <string_view>

#include "base/guarded.h"

namespace corba {
namespace {

struct Name {
  std::string text;
  std::string owner;  // its key; empty: `text` counts
};

using Names = std::map<std::string, Name, std::less<>>;

// Never destroyed: calls may come at the very end.
base::Guarded<Names, base::Rank::objects>& names() {
  static auto& all = *new base::Guarded<Names, base::Rank::objects>;
  return all;
}

}  // namespace

std::string object_key(CORBA::Object_ptr object) {
  if (CORBA::is_nil(object)) return {};
  const omniIOR_var ior = object->_PR_getobj()->_getIOR();
  for (CORBA::ULong i = 0; i < ior->iopProfiles().length(); ++i) {
    const auto& profile = ior->iopProfiles()[i];
    if (profile.tag != IOP::TAG_INTERNET_IOP) continue;
    IIOP::ProfileBody body;
    IIOP::unmarshalProfile(profile, body);
    return {reinterpret_cast<const char*>(body.object_key.get_buffer()), body.object_key.length()};
  }
  return {};
}

std::string port_text(std::string name) {
  if (const auto dot = name.rfind('.'); dot != std::string::npos) name[dot] = ':';
  return "port " + name;
}

void name_object(CORBA::Object_ptr object, const std::string& name) {
  if (auto key = object_key(object); !key.empty()) names().lock()->insert_or_assign(std::move(key), Name{name, {}});
}

void name_object_as(CORBA::Object_ptr object, CORBA::Object_ptr owner) {
  auto key = object_key(object), key_of_owner = object_key(owner);
  if (!key.empty() && !key_of_owner.empty()) names().lock()->insert_or_assign(std::move(key), Name{{}, std::move(key_of_owner)});
}

void forget_object(CORBA::Object_ptr object) {
  if (const auto key = object_key(object); !key.empty()) names().lock()->erase(key);
}

std::string name_of_object(std::span<const std::byte> key) {
  auto known = names().lock();
  auto found = known->find(std::string_view(reinterpret_cast<const char*>(key.data()), key.size()));
  if (found != known->end() && !found->second.owner.empty()) found = known->find(found->second.owner);
  return found != known->end() ? found->second.text : "this process";
}

}  // namespace corba

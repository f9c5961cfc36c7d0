#include "rtm/NamingManager.h"

#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "corba/naming.h"
#include "corba/orb.h"
#include "rtm/Manager.h"
#include "rtm/ManagerServant.h"
#include "rtm/RTObject.h"

#include <rtm/idl/ManagerStub.h>

namespace RTC {
namespace {

std::chrono::milliseconds milliseconds_of(const Manager& manager, const char* key, double otherwise) {
  const double seconds = base::parse_number(manager.configValue(key)).value_or(otherwise);
  constexpr double longest = 1e6;
  return std::chrono::milliseconds(static_cast<std::int64_t>(std::clamp(seconds, 0.0, longest) * 1000.0));
}

corba::BindingsSettings settings_of(const Manager& manager) {
  corba::BindingsSettings settings;
  settings.call_timeout = std::max(milliseconds_of(manager, "naming.update.timeout", 1.0), std::chrono::milliseconds(50));
  settings.interval = milliseconds_of(manager, "naming.update.interval", 10.0);
  if (!base::parse_bool(manager.configValue("naming.update.enable")).value_or(true)) settings.interval = std::chrono::milliseconds(0);
  settings.always_rebind = base::parse_bool(manager.configValue("naming.update.rebind")).value_or(false);
  return settings;
}

void append(RTCList& list, CORBA::Object_ptr object, std::chrono::milliseconds timeout) {
  try {
    if (CORBA::is_nil(object)) return;
    // The time-out holds for looking only: the reference handed out is another one.
    corba::set_call_timeout(object, timeout);
    RTObject_var component = RTObject::_narrow(object);
    if (CORBA::is_nil(component)) return;
    list.length(list.length() + 1);
    list[list.length() - 1] = component;
  } catch (const CORBA::Exception&) {  // an entry of something dead
    return;
  }
}

// "scheme://rest" or "scheme.corba://rest" -> rest.
bool take_scheme(std::string_view& text, std::string_view scheme) {
  for (const auto& form : {std::string(scheme) + "://", std::string(scheme) + ".corba://"}) {
    if (!text.starts_with(form)) continue;
    text.remove_prefix(form.size());
    return true;
  }
  return false;
}

}  // namespace

struct NamingManager::Impl {
  Manager* manager;
  corba::BindingsSettings settings;
  corba::Bindings bindings;
  std::vector<std::string> objects;

  explicit Impl(Manager* owner) : manager(owner), settings(settings_of(*owner)), bindings(owner->getORB(), settings) {}

  // Components bound anywhere on the service under `<instance>` with kind rtc.
  RTCList search(const std::string& server, const std::string& instance) {
    RTCList found;
    auto root = corba::root_context(manager->getORB(), server, settings.call_timeout);
    if (!root) return found;
    try {
      const auto names = corba::find_names(root->in(), [&](const CosNaming::NameComponent& component) {
        return instance == component.id.in() && std::string_view(component.kind) == "rtc";
      });
      for (const auto& name : names) {
        CORBA::Object_var object = (*root)->resolve(name);
        append(found, object, settings.call_timeout);
      }
    } catch (const CORBA::Exception& e) {
      base::log(base::Level::warn, "naming", "{}: looking for {} failed: {}", server, base::in_quotes(instance), corba::to_text(e));
    }
    return found;
  }

  RTCList by_name(std::string_view address) {
    RTCList found;
    const auto slash = address.find('/');
    if (slash == std::string_view::npos) return found;
    const std::string host(address.substr(0, slash));
    std::string path(address.substr(slash + 1));
    const auto servers = host == "*" ? bindings.servers() : std::vector<std::string>{host};
    for (const auto& server : servers) {
      if (path.starts_with("*/") || (host == "*" && path.find('/') == std::string::npos)) {
        const auto instance = path.starts_with("*/") ? path.substr(2) : path;
        found = search(server, instance);
      } else {
        auto name = corba::parse_name(path);
        if (!name) return found;
        auto& last = (*name)[name->length() - 1];
        if (*last.kind.in() == '\0') last.kind = "rtc";
        auto root = corba::root_context(manager->getORB(), server, settings.call_timeout);
        if (!root) continue;
        try {
          CORBA::Object_var object = (*root)->resolve(*name);
          append(found, object, settings.call_timeout);
        } catch (const CORBA::Exception&) {  // not there
          continue;
        }
      }
      if (found.length() > 0) break;
    }
    return found;
  }

  RTCList by_location(std::string_view address) {
    RTCList found;
    const auto slash = address.find('/');
    if (slash == std::string_view::npos) return found;
    const std::string host(address.substr(0, slash));
    const std::string path(address.substr(slash + 1));
    try {
      const auto url = "corbaloc:iiop:" + host + "/" + manager->configValue("manager.name");
      CORBA::Object_var object = manager->getORB()->string_to_object(url.c_str());
      corba::set_call_timeout(object, settings.call_timeout);
      RTM::Manager_var other = RTM::Manager::_narrow(object);
      if (CORBA::is_nil(other)) return found;
      corba::set_call_timeout(other, settings.call_timeout);
      RTCList_var list = other->get_components_by_name(path.c_str());
      found = list.in();
    } catch (const CORBA::Exception& e) {
      base::log(base::Level::warn, "naming", "manager {} does not answer: {}", host, corba::to_text(e));
    }
    return found;
  }
};

NamingManager::NamingManager(Manager* manager) : impl_(std::make_unique<Impl>(manager)) {}
NamingManager::~NamingManager() = default;

void NamingManager::registerNameServer(const char* method, const char* name_server) {
  if (method == nullptr || std::string_view(method) != "corba" || name_server == nullptr) return;
  impl_->bindings.add_server(name_server);
}

void NamingManager::bindObject(const char* name, const RTObject_impl* rtobj) {
  RTObject_var reference = rtobj->getObjRef();
  bindObject(std::string(name), reference);
}

void NamingManager::bindObject(const char* name, const RTM::ManagerServant* servant) {
  bindObject(std::string(name), servant->getObjRef());
}
void NamingManager::bindObject(const std::string& name, CORBA::Object_ptr object) { impl_->bindings.bind(name, object); }
void NamingManager::bindPortObject(const char* name, PortService_ptr port) { impl_->bindings.bind(name, port); }
void NamingManager::unbindObject(const char* name) { impl_->bindings.unbind(name); }
void NamingManager::unbindAll() { impl_->bindings.unbind_all(); }
void NamingManager::update() { impl_->bindings.refresh(); }

RTCList NamingManager::string_to_component(const std::string& name) {
  std::string_view text = base::trim(name);
  if (take_scheme(text, "rtcname")) return impl_->by_name(text);
  if (take_scheme(text, "rtcloc")) return impl_->by_location(text);
  RTCList found;
  if (auto* component = impl_->manager->getComponent(std::string(text))) {
    found.length(1);
    found[0] = component->getObjRef();
  }
  return found;
}

CORBA::Object_ptr NamingManager::resolve(const std::string& name) {
  const auto parsed = corba::parse_name(name);
  if (!parsed) return CORBA::Object::_nil();
  for (const auto& server : impl_->bindings.servers()) {
    auto root = corba::root_context(impl_->manager->getORB(), server, impl_->settings.call_timeout);
    if (!root) continue;
    try {
      return (*root)->resolve(*parsed);
    } catch (const CORBA::Exception&) {  // not on this one
      continue;
    }
  }
  return CORBA::Object::_nil();
}

bool NamingManager::isInstanceTaken(const std::string& instance_name, bool this_host_only) {
  const auto host = impl_->manager->configValue("os.hostname");
  for (const auto& server : impl_->bindings.servers()) {
    auto root = corba::root_context(impl_->manager->getORB(), server, impl_->settings.call_timeout);
    if (!root) continue;
    try {
      const auto names = corba::find_names(root->in(), [&](const CosNaming::NameComponent& component) {
        return instance_name == component.id.in() && std::string_view(component.kind) == "rtc";
      });
      for (const auto& name : names) {
        const bool is_here = name.length() < 2 || host == name[0].id.in() || std::string_view(name[0].kind) != "host_cxt";
        if (this_host_only && !is_here) continue;
        RTCList alive;
        CORBA::Object_var object = (*root)->resolve(name);
        append(alive, object, impl_->settings.call_timeout);
        if (alive.length() > 0) return true;
      }
    } catch (const CORBA::Exception& e) {
      base::log(base::Level::warn, "naming", "{}: looking for {} failed: {}", server, base::in_quotes(instance_name), corba::to_text(e));
    }
  }
  return false;
}

}  // namespace RTC

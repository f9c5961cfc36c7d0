#include "rtm/NamingManager.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

#include "base/log.h"
#include "base/own_account.h"
#include "base/text.h"
#include "corba/orb/naming.h"
#include "corba/orb/orb.h"
#include "corba/orb/principal.h"
#include "manager/manager_impl.h"
#include "rtm/CORBA_IORUtil.h"
#include "rtm/ManagerServant.h"

#include <rtm/idl/ManagerStub.h>

namespace RTC {
namespace {

std::chrono::milliseconds milliseconds_of(const Manager& manager, const char* key, double otherwise) {
  const double seconds = base::parse_number(manager.configValue(key)).value_or(otherwise);
  constexpr double longest = 1e6;
  return std::chrono::milliseconds(static_cast<std::int64_t>(std::clamp(seconds, 0.0, longest) * 1000.0));
}

// This host's address on the way to another; empty if that is no address or there is no way. Nothing is sent.
std::string local_address_towards(const std::string& server) {
  const auto colon = server.rfind(':');
  const auto host = server.substr(0, colon);
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  addrinfo* found = nullptr;
  if (host.find(':') != std::string::npos || getaddrinfo(host.c_str(), "2809", &hints, &found) != 0) return {};
  std::string address;
  if (const int socket = ::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC, 0); socket >= 0) {
    sockaddr_storage ours{};
    socklen_t size = sizeof ours;
    char text[NI_MAXHOST] = "";
    if (connect(socket, found->ai_addr, found->ai_addrlen) == 0 && getsockname(socket, reinterpret_cast<sockaddr*>(&ours), &size) == 0 &&
        getnameinfo(reinterpret_cast<sockaddr*>(&ours), size, text, sizeof text, nullptr, 0, NI_NUMERICHOST) == 0) {
      address = text;
    }
    close(socket);
  }
  freeaddrinfo(found);
  return address;
}

// A reference that leads to the address by which the server is reached from here: for hosts with several networks.
CORBA::Object_ptr with_address_towards(CORBA::ORB_ptr orb, CORBA::Object_ptr object, const std::string& server) {
  const auto address = local_address_towards(server);
  CORBA::String_var given = orb->object_to_string(object);
  std::string text(given.in());
  if (address.empty() || !CORBA_IORUtil::replaceEndpoint(text, address)) return CORBA::Object::_duplicate(object);
  return orb->string_to_object(text.c_str());
}

corba::BindingsSettings settings_of(const Manager& manager, CORBA::ORB_ptr the_orb) {
  corba::BindingsSettings settings;
  settings.call_timeout = std::max(milliseconds_of(manager, "naming.update.timeout", 1.0), std::chrono::milliseconds(50));
  settings.interval = milliseconds_of(manager, "naming.update.interval", 10.0);
  if (!base::parse_bool(manager.configValue("naming.update.enable")).value_or(true)) settings.interval = std::chrono::milliseconds(0);
  settings.always_rebind = base::parse_bool(manager.configValue("naming.update.rebind")).value_or(false);
  if (base::parse_bool(manager.configValue("corba.nameservice.replace_endpoint")).value_or(false)) {
    settings.present = [orb = CORBA::ORB_var(CORBA::ORB::_duplicate(the_orb))](CORBA::Object_ptr object, const std::string& server) {
      return with_address_towards(orb, object, server);
    };
  }
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
  std::vector<std::string> managers;  // host:port of those asked for names; set before anybody asks

  explicit Impl(Manager* owner) : manager(owner), settings(settings_of(*owner, owner->getORB())), bindings(owner->getORB(), settings) {}

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
    return at_manager(std::string(address.substr(0, slash)), std::string(address.substr(slash + 1)));
  }

  // Nil if none answers there.
  RTM::Manager_var manager_at(const std::string& host) {
    try {
      const auto url = "corbaloc:iiop:" + base::with_numeric_host(host) + "/" + manager->configValue("manager.name");
      CORBA::Object_var object = manager->getORB()->string_to_object(url.c_str());
      corba::set_call_timeout(object, settings.call_timeout);
      RTM::Manager_var other = RTM::Manager::_narrow(object);
      if (!CORBA::is_nil(other)) corba::set_call_timeout(other, settings.call_timeout);
      return other;
    } catch (const CORBA::Exception& e) {
      base::log(base::Level::debug, "naming", "manager {} does not answer: {}", host, corba::to_text(e));
      return RTM::Manager::_nil();
    }
  }

  // `instance`, `category/instance` or `*/instance`, of the manager and its slaves.
  RTCList at_manager(const std::string& host, const std::string& path) {
    RTCList found;
    RTM::Manager_var other = manager_at(host);
    if (CORBA::is_nil(other)) return found;
    try {
      RTCList_var list = other->get_components_by_name(path.c_str());
      found = list.in();
      if (found.length() > 0) return found;
      RTM::ManagerList_var slaves = other->get_slave_managers();
      for (CORBA::ULong i = 0; i < slaves->length() && found.length() == 0; ++i) {
        RTM::Manager_var slave = slaves[i];
        corba::set_call_timeout(slave, settings.call_timeout);
        list = slave->get_components_by_name(path.c_str());
        found = list.in();
      }
    } catch (const CORBA::Exception& e) {
      base::log(base::Level::warn, "naming", "manager {} does not answer: {}", host, corba::to_text(e));
    }
    return found;
  }

  RTCList at_managers(const std::string& path) {
    for (const auto& host : managers) {
      auto found = at_manager(host, path);
      if (found.length() > 0) return found;
    }
    return {};
  }
};

NamingManager::NamingManager(Manager* manager) : impl_(std::make_unique<Impl>(manager)) {}
NamingManager::~NamingManager() = default;

void NamingManager::registerNameServer(const char* method, const char* name_server) {
  if (method == nullptr || name_server == nullptr) return;
  if (std::string_view(method) == "corba") impl_->bindings.add_server(name_server);
  if (std::string_view(method) == "manager") impl_->managers.emplace_back(name_server);
}

void NamingManager::bindObject(const char* name, const RTObject_impl* rtobj) {
  RTObject_var reference = manage(rtobj)->reference();
  bindObject(std::string(name), reference);
}

void NamingManager::bindObject(const char* name, const RTM::ManagerServant* servant) {
  bindObject(std::string(name), servant->getObjRef());
}
void NamingManager::bindUnlessTaken(const char* name, const RTM::ManagerServant* servant) {
  impl_->bindings.bind(name, servant->getObjRef(), true);
}
void NamingManager::bindObject(const std::string& name, CORBA::Object_ptr object) {
  impl_->bindings.bind(name, object,
                       corba::principal() != corba::Principal::own);  // a stranger's component takes no name from a living one
}
void NamingManager::bindPortObject(const char* name, PortService_ptr port) { bindObject(name, port); }
void NamingManager::unbindObject(const char* name) { impl_->bindings.unbind(name); }
void NamingManager::unbindAll() { impl_->bindings.unbind_all(); }
void NamingManager::update() { impl_->bindings.refresh(); }

RTCList NamingManager::string_to_component(const std::string& name) {
  std::string_view text = base::trim(name);
  if (take_scheme(text, "rtcname")) return impl_->by_name(text);
  if (take_scheme(text, "rtcloc")) return impl_->by_location(text);
  RTCList found;
  if (const auto component = impl_->manager->impl_->held_component(std::string(text)); component) {
    found.length(1);
    found[0] = component->reference();
    return found;
  }
  return impl_->at_managers(std::string(text));
}

std::vector<CORBA::Object_var> NamingManager::list(const std::string& context, const std::string& kind) {
  std::vector<CORBA::Object_var> found;
  const auto path = corba::parse_name(context);
  if (!path) return found;
  for (const auto& server : impl_->bindings.servers()) {
    auto root = corba::root_context(impl_->manager->getORB(), server, impl_->settings.call_timeout);
    if (!root) continue;
    try {
      CORBA::Object_var object = (*root)->resolve(*path);
      corba::set_call_timeout(object, impl_->settings.call_timeout);
      CosNaming::NamingContext_var below = CosNaming::NamingContext::_narrow(object);
      if (CORBA::is_nil(below)) continue;
      corba::set_call_timeout(below, impl_->settings.call_timeout);
      const auto names = corba::find_names(below, [&](const CosNaming::NameComponent& component) { return kind == component.kind.in(); });
      for (const auto& name : names) found.emplace_back(below->resolve(name));
    } catch (const CORBA::Exception&) {  // no such context there
      continue;
    }
  }
  return found;
}

RTCList NamingManager::componentsOfManagers() {
  RTCList all;
  for (const auto& host : impl_->managers) {
    RTM::Manager_var other = impl_->manager_at(host);
    if (CORBA::is_nil(other)) continue;
    try {
      RTCList_var list = other->get_components();
      const auto before = all.length();
      all.length(before + list->length());
      for (CORBA::ULong i = 0; i < list->length(); ++i) all[before + i] = RTObject::_duplicate(list[i]);
    } catch (const CORBA::Exception&) {  // gone meanwhile
      continue;
    }
  }
  return all;
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
  if (impl_->at_managers(instance_name).length() > 0) return true;
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

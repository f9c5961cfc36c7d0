#include "rtm/LocalServiceAdmin.h"

#include <algorithm>

#include <coil/stringutil.h>

namespace RTM {

LocalServiceAdmin& LocalServiceAdmin::instance() {
  static LocalServiceAdmin admin;
  return admin;
}

void LocalServiceAdmin::init(coil::Properties& properties) {
  const auto enabled = coil::split(properties.getProperty("enabled_services", "ALL"), ",", true);
  const bool all =
      std::any_of(enabled.begin(), enabled.end(), [](const auto& name) { return coil::normalize(std::string(name)) == "all"; });
  auto& factory = LocalServiceFactory::instance();
  for (const auto& name : factory.getIdentifiers()) {
    if (!all && std::find(enabled.begin(), enabled.end(), name) == enabled.end()) continue;
    auto* service = factory.createObject(name);
    if (service == nullptr) continue;
    if (!service->init(properties.getNode(name)) || !addLocalService(service)) {
      service->finalize();
      factory.deleteObject(service);
    }
  }
}

void LocalServiceAdmin::finalize() {
  std::vector<LocalServiceBase*> services;
  {
    const std::scoped_lock lock(mutex_);
    services.swap(services_);
  }
  for (auto* service : services) {
    service->finalize();
    LocalServiceFactory::instance().deleteObject(service);
  }
}

LocalServiceProfileList LocalServiceAdmin::getServiceProfiles() {
  std::vector<LocalServiceBase*> services;
  {
    const std::scoped_lock lock(mutex_);
    services = services_;
  }
  LocalServiceProfileList profiles;
  for (auto* service : services) profiles.push_back(service->getProfile());
  return profiles;
}

bool LocalServiceAdmin::getServiceProfile(const std::string& name, LocalServiceProfile& profile) {
  for (const auto& known : getServiceProfiles()) {
    if (known.name != name) continue;
    profile = known;
    return true;
  }
  return false;
}

LocalServiceBase* LocalServiceAdmin::getService(const char* id) {
  for (const auto& profile : getServiceProfiles()) {
    if (profile.name == id || profile.uuid == id) return profile.service;
  }
  return nullptr;
}

bool LocalServiceAdmin::addLocalService(LocalServiceBase* service) {
  if (service == nullptr || getService(service->getProfile().name.c_str()) != nullptr) return false;
  const std::scoped_lock lock(mutex_);
  services_.push_back(service);
  return true;
}

bool LocalServiceAdmin::removeLocalService(const std::string& name) {
  auto* service = getService(name.c_str());
  if (service == nullptr) return false;
  {
    const std::scoped_lock lock(mutex_);
    std::erase(services_, service);
  }
  service->finalize();
  LocalServiceFactory::instance().deleteObject(service);
  return true;
}

}  // namespace RTM

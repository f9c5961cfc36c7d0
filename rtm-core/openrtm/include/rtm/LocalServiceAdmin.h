// The local services that manager.local_service.enabled_services switches on. Any thread.
#pragma once

#include <rtm/LocalServiceBase.h>

#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace RTM {

class LocalServiceAdmin {
 public:
  static LocalServiceAdmin& instance();

  // `properties`: the node manager.local_service of the configuration. Every registered service that is enabled is made and initialised.
  void init(coil::Properties& properties);
  void finalize();

  LocalServiceProfileList getServiceProfiles();
  bool getServiceProfile(const std::string& name, LocalServiceProfile& profile);
  // By name or uuid; nullptr if there is none.
  LocalServiceBase* getService(const char* id);
  // Takes over the service. False if one of that name is there.
  bool addLocalService(LocalServiceBase* service);
  bool removeLocalService(const std::string& name);

 private:
  LocalServiceAdmin() = default;
  std::mutex mutex_;
  std::vector<LocalServiceBase*> services_;  // from coil's factory or added; given back in finalize
};

}  // namespace RTM

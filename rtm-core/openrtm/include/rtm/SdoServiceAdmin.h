// The SDO services of one component: those it offers (providers) and those that tools have attached (consumers). Any thread; services are
// called without a lock.
#pragma once

#include <coil/Properties.h>
#include <rtm/SdoServiceConsumerBase.h>
#include <rtm/SdoServiceProviderBase.h>

#include <memory>
#include <string>
#include <vector>

namespace RTC {

class RTObject_impl;

class SdoServiceAdmin {
 public:
  explicit SdoServiceAdmin(RTObject_impl& rtobj);
  ~SdoServiceAdmin();

  // Takes sdo.service.provider.enabled_services and sdo.service.consumer.enabled_services (ALL or a list of repository ids), and makes the
  // enabled providers that have been registered.
  void init(const coil::Properties& props);
  // Ends every service.
  void exit();

  SDOPackage::ServiceProfileList* getServiceProviderProfiles() const;
  // By id or, if there is none, by interface type; null when there is none. The caller owns it.
  SDOPackage::ServiceProfile* getServiceProviderProfile(const char* id) const;
  // Takes over one reference to the servant. False when the id is in use.
  bool addSdoServiceProvider(const SDOPackage::ServiceProfile& profile, SdoServiceProviderBase* provider);
  bool removeSdoServiceProvider(const char* id);

  // False when nobody knows the interface, it is not enabled, or the service is not what it says.
  bool addSdoServiceConsumer(const SDOPackage::ServiceProfile& profile);
  bool removeSdoServiceConsumer(const char* id);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Registers our consumers: both component observers and the logger. Calling it again changes nothing.
void registerBuiltinSdoServices();

}  // namespace RTC

// Base of an SDO service that a component offers (SDO::get_sdo_service). A servant; any thread.
#pragma once

#include <coil/Factory.h>
#include <rtm/idl/SDOPackageSkel.h>

namespace RTC {

class RTObject_impl;

class SdoServiceProviderBase : public virtual POA_SDOPackage::SDOService, public virtual PortableServer::RefCountServantBase {
 public:
  virtual bool init(RTObject_impl& rtobj, const SDOPackage::ServiceProfile& profile) = 0;
  virtual bool reinit(const SDOPackage::ServiceProfile& profile) = 0;
  virtual const SDOPackage::ServiceProfile& getProfile() const = 0;
  virtual void finalize() = 0;
};

using SdoServiceProviderFactory = coil::GlobalFactory<SdoServiceProviderBase>;

}  // namespace RTC

// Base of what uses an SDO service that a tool attaches to a component (Configuration::add_service_profile). A type is registered for the
// repository id of the service's interface. One thread at a time.
#pragma once

#include <coil/Factory.h>
#include <coil/Timer.h>
#include <rtm/NVUtil.h>
#include <rtm/RTObject.h>
#include <rtm/idl/SDOPackageSkel.h>

namespace RTC {

class RTObject_impl;

class SdoServiceConsumerBase {
 public:
  virtual ~SdoServiceConsumerBase() = default;
  // False when the service in the profile is not of the right interface.
  virtual bool init(RTObject_impl& rtobj, const SDOPackage::ServiceProfile& profile) = 0;
  // The same id is attached again, with other properties.
  virtual bool reinit(const SDOPackage::ServiceProfile& profile) = 0;
  virtual const SDOPackage::ServiceProfile& getProfile() const = 0;
  // Nothing is called any more after return.
  virtual void finalize() = 0;
};

using SdoServiceConsumerFactory = coil::GlobalFactory<SdoServiceConsumerBase>;

}  // namespace RTC

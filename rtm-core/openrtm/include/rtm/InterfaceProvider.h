// Common base of the ends of an author's transport that their peer calls: their names and what they add to the profile of a connection. One
// thread.
#pragma once

#include <rtm/SystemLogger.h>
#include <rtm/idl/RTCStub.h>

#include <string>

namespace RTC {

class InterfaceProvider {
 public:
  InterfaceProvider() = default;
  virtual ~InterfaceProvider() = default;
  InterfaceProvider(const InterfaceProvider&) = delete;
  InterfaceProvider& operator=(const InterfaceProvider&) = delete;

  // Of ports; the port says the same by itself.
  virtual void publishInterfaceProfile(SDOPackage::NVList& properties);
  // Appends m_properties to those of the connection; false when the connection is for another interface.
  virtual bool publishInterface(SDOPackage::NVList& properties);

 protected:
  void setInterfaceType(const char* type) { interface_type_ = type; }
  void setDataFlowType(const char* type) { dataflow_type_ = type; }
  void setSubscriptionType(const char* type) { subscription_type_ = type; }

  SDOPackage::NVList m_properties{};
  mutable Logger rtclog{"interface"};

 private:
  std::string interface_type_;
  std::string dataflow_type_;
  std::string subscription_type_;
};

}  // namespace RTC

// The SDO service RTC::ExtendedFsmService, which shows the state machine of a component to tools. Any thread.
#pragma once

#include <rtm/SdoServiceProviderBase.h>
#include <rtm/idl/ExtendedFsmServiceSkel.h>

#include <functional>
#include <string>

#include "base/guarded.h"
#include "corba/orb/gate.h"

namespace RTC {

class ExtendedFsmServiceProvider : public SdoServiceProviderBase, public virtual POA_RTC::ExtendedFsmService {
 public:
  static constexpr const char* interface_id = "IDL:omg.org/RTC/ExtendedFsmService:1.0";

  // `current_state` is asked whenever a tool asks.
  ExtendedFsmServiceProvider(std::function<std::string()> current_state, const FsmStructure& structure);

  // Offers the service at the component, which then owns it. Null when the component offers one already.
  static ExtendedFsmServiceProvider* offer(RTObject_impl& component, std::function<std::string()> current_state,
                                           const FsmStructure& structure);

  char* get_current_state() override;
  // What tools see; the machine itself is code and stays as it is. BAD_PARAMETER for another machine's name.
  ReturnCode_t set_fsm_structure(const FsmStructure& fsm_structure) override;
  ReturnCode_t get_fsm_structure(FsmStructure_out fsm_structure) override;

  bool init(RTObject_impl& rtobj, const SDOPackage::ServiceProfile& profile) override;
  bool reinit(const SDOPackage::ServiceProfile& profile) override;
  const SDOPackage::ServiceProfile& getProfile() const override { return profile_; }
  void finalize() override;

 private:
  struct Data {
    std::function<std::string()> current_state{};
    RTObject_impl* component = nullptr;
    FsmStructure structure{};
  };
  base::Guarded<Data, base::Rank::component> shared_;
  corba::Gate gate_;  // closed before the machine and the component go
  SDOPackage::ServiceProfile profile_;
};

}  // namespace RTC

// A port of service interfaces: providers, which others call, and consumers, which call others. register*: before the port is used;
// the rest: any thread.
#pragma once

#include <list>
#include <memory>
#include <string>
#include <vector>

#include "rtm/CorbaConsumer.h"
#include "rtm/NVUtil.h"
#include "rtm/PortBase.h"

namespace RTC {

class CorbaPort : public PortBase {
 public:
  explicit CorbaPort(const char* name);
  ~CorbaPort() override;

  void init(coil::Properties& properties) override;

  // The servant and the consumer must outlive the port. False if there is one of that instance and type name already. `type_name` is free
  // text; connections match by it.
  bool registerProvider(const char* instance_name, const char* type_name, PortableServer::ServantBase& provider);
  bool registerConsumer(const char* instance_name, const char* type_name, CorbaConsumerBase& consumer);

  // Providers can be called between these two only.
  void activateInterfaces() override;
  void deactivateInterfaces() override;

 protected:
  void complete_profile(ConnectorProfile& profile) override;
  std::shared_ptr<detail::PortTerms> read_terms(const ConnectorProfile& profile) override;
  ReturnCode_t publishInterfaces(ConnectorProfile& profile) override;
  ReturnCode_t subscribeInterfaces(const ConnectorProfile& profile) override;
  void unsubscribeInterfaces(const ConnectorProfile& profile) override;

 private:
  struct Provider;
  struct Consumer;
  struct State;

  std::unique_ptr<State> state_;
};

}  // namespace RTC

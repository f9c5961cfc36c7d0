// See coil/Properties.h.
#pragma once

#include <rtm/PortBase.h>

namespace RTC {

class CorbaConsumerBase;

class CorbaPort : public PortBase {
 public:
  explicit CorbaPort(const char* name);
  bool registerProvider(const char* instance_name, const char* type_name, PortableServer::RefCountServantBase& provider);
  bool registerConsumer(const char* instance_name, const char* type_name, CorbaConsumerBase& consumer);
};

}  // namespace RTC

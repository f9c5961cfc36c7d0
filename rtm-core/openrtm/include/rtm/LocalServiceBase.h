// Services inside the process that plug-ins offer by name. The manager calls them from one thread at a time.
#pragma once

#include <coil/Factory.h>
#include <coil/Properties.h>

#include <string>
#include <vector>

namespace RTM {

class LocalServiceBase;

struct LocalServiceProfile {
  std::string name;
  std::string uuid;
  coil::Properties properties;
  LocalServiceBase* service = nullptr;
};
using LocalServiceProfileList = std::vector<LocalServiceProfile>;

class LocalServiceBase {
 public:
  virtual ~LocalServiceBase() = default;
  virtual bool init(const coil::Properties& properties) = 0;
  virtual bool reinit(const coil::Properties& properties) = 0;
  virtual const LocalServiceProfile& getProfile() const = 0;
  virtual void finalize() = 0;
};

using LocalServiceFactory = coil::GlobalFactory<LocalServiceBase>;

}  // namespace RTM

#include "manager/scripts.h"

#include "manager/manager_impl.h"
#include "rtm/ModuleManager.h"

namespace RTC {

bool register_factory(Manager& manager, std::shared_ptr<FactoryBase> factory) {
  return ManagerImpl::of(manager).register_factory(std::move(factory));
}

void set_script_loader(Manager& manager, ScriptLoader loader) { ManagerImpl::of(manager).modules->setScriptLoader(std::move(loader)); }

}  // namespace RTC

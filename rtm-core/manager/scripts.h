// Adds factories and loaders of another language to the manager of a process (python/openrtm). Any thread, between Manager::init and
// activateManager. Not installed.
#pragma once

#include <rtm/Factory.h>

#include <functional>
#include <memory>
#include <string>

namespace RTC {

class Manager;

// As Manager::registerFactory, for a factory that has more than two functions. False if one of the same id exists.
bool register_factory(Manager& manager, std::shared_ptr<FactoryBase> factory);

// Loads a module that is no library: calls its init function, or the one that is named. Empty, or one line that says why it failed. It is
// called without a lock.
using ScriptLoader = std::function<std::string(const std::string& file, const std::string& init_function)>;
void set_script_loader(Manager& manager, ScriptLoader loader);

}  // namespace RTC

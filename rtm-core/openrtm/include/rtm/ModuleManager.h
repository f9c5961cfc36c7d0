// The shared libraries that components come in. Any thread; the manager is the only user besides plug-ins.
#pragma once

#include <rtm/RTC.h>

#include <coil/Properties.h>
#include <coil/stringutil.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace RTC {

class Manager;

class ModuleManager {
 public:
  explicit ModuleManager(Manager* manager);
  ~ModuleManager();
  ModuleManager(const ModuleManager&) = delete;
  ModuleManager& operator=(const ModuleManager&) = delete;

  // The file that a module name means: a path as it is, else the name, also with the suffix .so, in manager.modules.load_path. Empty if
  // there is none.
  std::string findFile(const std::string& name) const;
  // The default init function of a file.
  static std::string initFunction(const std::string& file);

  // `module`: name or path, also `name(initfunc)`. RTC_OK also if it is loaded already.
  ReturnCode_t load(const std::string& module, const std::string& init_function, std::string& error);
  // For modules that are no libraries (*.py): called with file and init function, without a lock; says in one line why it failed. Set
  // before any module is loaded.
  void setScriptLoader(std::function<std::string(const std::string& file, const std::string& init_function)> loader);
  ReturnCode_t unload(const std::string& name);
  void unloadAll();
  void* symbol(const std::string& name, const std::string& function) const;

  std::vector<coil::Properties> getLoadedModules() const;
  std::vector<coil::Properties> getLoadableModules();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace RTC

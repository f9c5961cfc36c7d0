// The configuration sets of a component and the variables bound to their parameters, in classic spelling. Any thread, but variables are
// written only by update(), which belongs to the thread of the execution context (and to onInitialize). Listeners are called without a
// lock.
#pragma once

#include <coil/Properties.h>
#include <coil/stringutil.h>
#include <rtm/ConfigurationListener.h>

#include <functional>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace RTC {

// The names of 1.0.
using OnUpdateCallback = ConfigurationSetNameListener;
using OnUpdateParamCallback = ConfigurationParamListener;
using OnSetConfigurationSetCallback = ConfigurationSetListener;
using OnAddConfigurationAddCallback = ConfigurationSetListener;
using OnRemoveConfigurationSetCallback = ConfigurationSetNameListener;
using OnActivateSetCallback = ConfigurationSetNameListener;

class ConfigAdmin {
 public:
  // Sets live at conf.<set>.<parameter> of a component's properties.
  ConfigAdmin();
  explicit ConfigAdmin(const coil::Properties& conf);
  ~ConfigAdmin();
  ConfigAdmin(const ConfigAdmin&) = delete;
  ConfigAdmin& operator=(const ConfigAdmin&) = delete;

  // Merges the sets below the node into what is here; no listener is called.
  void load(const coil::Properties& conf);

  // Binds a variable, which must outlive this object; it takes the value of the active set at once, the default when there is none or when
  // it cannot be converted. False when a variable of that name is bound already.
  template <typename VarType>
  bool bindParameter(const char* param_name, VarType& var, const char* def_val, bool (*trans)(VarType&, const char*) = coil::stringTo) {
    return bind(param_name, def_val, [&var, trans](const char* text) { return trans(var, text); });
  }
  template <typename VarType, typename Function, std::enable_if_t<std::is_invocable_r_v<bool, Function, VarType&, const char*>, int> = 0>
  bool bindParameter(const char* param_name, VarType& var, const char* def_val, Function trans) {
    return bind(param_name, def_val, [&var, trans](const char* text) { return trans(var, text); });
  }
  bool unbindParameter(const char* param_name);

  // Writes the values of the active set to the variables if something has changed.
  void update();
  // Writes the values of that set, or of one parameter of it, whatever is active.
  void update(const char* config_set);
  void update(const char* config_set, const char* config_param);

  bool isExist(const char* param_name) const;
  bool isChanged() const;
  void changedParam(const char*, const char*) {}
  // Valid until this thread asks again.
  const char* getActiveId() const;
  bool haveConfig(const char* config_id) const;
  // False from a change of any set until one is activated.
  bool isActive() const;
  std::vector<std::string> getParameterNames() const;

  // Copies: changing them changes nothing here.
  std::vector<coil::Properties> getConfigurationSets() const;
  coil::Properties getConfigurationSet(const char* config_id) const;
  coil::Properties getActiveConfigurationSet() const;

  // The node's name is the set's id. Merges into an existing set; false if there is none of that id.
  bool setConfigurationSetValues(const coil::Properties& config_set);
  bool addConfigurationSet(const coil::Properties& config_set);
  // Only sets that were added by addConfigurationSet and are not active.
  bool removeConfigurationSet(const char* config_id);
  // False for unknown sets and those that start with an underscore.
  bool activateConfigurationSet(const char* config_id);

  void addConfigurationParamListener(ConfigurationParamListenerType type, ConfigurationParamListener* listener, bool autoclean = true);
  void removeConfigurationParamListener(ConfigurationParamListenerType type, ConfigurationParamListener* listener);
  void addConfigurationSetListener(ConfigurationSetListenerType type, ConfigurationSetListener* listener, bool autoclean = true);
  void removeConfigurationSetListener(ConfigurationSetListenerType type, ConfigurationSetListener* listener);
  void addConfigurationSetNameListener(ConfigurationSetNameListenerType type, ConfigurationSetNameListener* listener,
                                       bool autoclean = true);
  void removeConfigurationSetNameListener(ConfigurationSetNameListenerType type, ConfigurationSetNameListener* listener);

  // 1.0; the callbacks stay the caller's.
  void setOnUpdate(OnUpdateCallback* callback) {
    addConfigurationSetNameListener(ConfigurationSetNameListenerType::ON_UPDATE_CONFIG_SET, callback, false);
  }
  void setOnUpdateParam(OnUpdateParamCallback* callback) {
    addConfigurationParamListener(ConfigurationParamListenerType::ON_UPDATE_CONFIG_PARAM, callback, false);
  }
  void setOnSetConfigurationSet(OnSetConfigurationSetCallback* callback) {
    addConfigurationSetListener(ConfigurationSetListenerType::ON_SET_CONFIG_SET, callback, false);
  }
  void setOnAddConfigurationSet(OnAddConfigurationAddCallback* callback) {
    addConfigurationSetListener(ConfigurationSetListenerType::ON_ADD_CONFIG_SET, callback, false);
  }
  void setOnRemoveConfigurationSet(OnRemoveConfigurationSetCallback* callback) {
    addConfigurationSetNameListener(ConfigurationSetNameListenerType::ON_REMOVE_CONFIG_SET, callback, false);
  }
  void setOnActivateSet(OnActivateSetCallback* callback) {
    addConfigurationSetNameListener(ConfigurationSetNameListenerType::ON_ACTIVATE_CONFIG_SET, callback, false);
  }

  // Where a line goes for each value that a bound variable cannot take. Set before the first update.
  void setLog(std::function<void(const std::string& line)> say) { say_ = std::move(say); }

 private:
  bool bind(const char* name, const char* default_value, std::function<bool(const char*)> assign);
  template <class Update>
  void notify(const Update& update);

  class Sets;
  std::unique_ptr<Sets> configuration_;
  std::function<void(const std::string& line)> say_ = [](const std::string&) {};
  ConfigurationListeners listeners_;
};

}  // namespace RTC

// Listeners for changes of configuration sets. Called without a lock: update events on the thread of the execution context, the others on
// the thread that makes the change.
#pragma once

#include <coil/Properties.h>
#include <rtm/ListenerList.h>

#include <cstdint>

namespace RTC {

// 2.x writes the values with the name of their type, 1.x without.
enum ConfigurationParamListenerType : std::uint8_t { ON_UPDATE_CONFIG_PARAM, CONFIG_PARAM_LISTENER_NUM };
enum ConfigurationSetListenerType : std::uint8_t { ON_SET_CONFIG_SET, ON_ADD_CONFIG_SET, CONFIG_SET_LISTENER_NUM };
enum ConfigurationSetNameListenerType : std::uint8_t {
  ON_UPDATE_CONFIG_SET,
  ON_REMOVE_CONFIG_SET,
  ON_ACTIVATE_CONFIG_SET,
  CONFIG_SET_NAME_LISTENER_NUM
};

class ConfigurationParamListener {
 public:
  virtual ~ConfigurationParamListener() = default;
  virtual void operator()(const char* config_set_name, const char* config_param_name) = 0;
  static const char* toString(ConfigurationParamListenerType type);
};
class ConfigurationSetListener {
 public:
  virtual ~ConfigurationSetListener() = default;
  // The node is named like the set.
  virtual void operator()(const coil::Properties& config_set) = 0;
  static const char* toString(ConfigurationSetListenerType type);
};
class ConfigurationSetNameListener {
 public:
  virtual ~ConfigurationSetNameListener() = default;
  virtual void operator()(const char* config_set_name) = 0;
  static const char* toString(ConfigurationSetNameListenerType type);
};

class ConfigurationListeners {
 public:
  ListenerList<ConfigurationParamListener> configparam_[static_cast<int>(CONFIG_PARAM_LISTENER_NUM)];
  ListenerList<ConfigurationSetListener> configset_[static_cast<int>(CONFIG_SET_LISTENER_NUM)];
  ListenerList<ConfigurationSetNameListener> configsetname_[static_cast<int>(CONFIG_SET_NAME_LISTENER_NUM)];
};

}  // namespace RTC

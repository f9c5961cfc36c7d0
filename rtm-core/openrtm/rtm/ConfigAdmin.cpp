#include <rtm/ConfigAdmin.h>

#include "core/configuration.h"

namespace RTC {

namespace {

rt::Configuration::Set to_set(const coil::Properties& node) {
  rt::Configuration::Set set{node.getName(), {}};
  for (const std::string& name : node.propertyNames()) set.values.emplace_back(name, node.getProperty(name));
  return set;
}

coil::Properties to_properties(const rt::Configuration::Set& set) {
  coil::Properties node(set.id.c_str());
  for (const auto& [name, value] : set.values) node.setProperty(name, value);
  return node;
}

std::string text(const char* text) { return text ? text : ""; }

}  // namespace

class ConfigAdmin::Sets final : public rt::Configuration {};

ConfigAdmin::ConfigAdmin() : configuration_(std::make_unique<Sets>()) {}
ConfigAdmin::ConfigAdmin(const coil::Properties& conf) : ConfigAdmin() { load(conf); }
ConfigAdmin::~ConfigAdmin() = default;

void ConfigAdmin::load(const coil::Properties& conf) {
  for (const coil::Properties* set : conf.getLeaf()) configuration_->load(to_set(*set));
}

bool ConfigAdmin::bind(const char* name, const char* default_value, std::function<bool(const char*)> assign) {
  return name && default_value && configuration_->bind(name, default_value, std::move(assign));
}

bool ConfigAdmin::unbindParameter(const char* param_name) { return configuration_->unbind(text(param_name)); }

template <class Update>
void ConfigAdmin::notify(const Update& update) {
  for (const std::string& line : update.refused) say_(line);
  for (const std::string& parameter : update.parameters)
    listeners_.configparam_[static_cast<int>(ON_UPDATE_CONFIG_PARAM)].notify(update.set.c_str(), parameter.c_str());
  listeners_.configsetname_[static_cast<int>(ON_UPDATE_CONFIG_SET)].notify(update.set.c_str());
}

void ConfigAdmin::update() {
  if (const auto update = configuration_->update()) notify(*update);
}

void ConfigAdmin::update(const char* config_set) {
  if (const auto update = configuration_->update_from(text(config_set))) notify(*update);
}

void ConfigAdmin::update(const char* config_set, const char* config_param) {
  if (const auto update = configuration_->update_from(text(config_set), text(config_param))) notify(*update);
}

bool ConfigAdmin::isExist(const char* param_name) const { return configuration_->is_bound(text(param_name)); }
bool ConfigAdmin::isChanged() const { return configuration_->has_changed(); }
const char* ConfigAdmin::getActiveId() const {
  thread_local std::string id;
  id = configuration_->active_id();
  return id.c_str();
}
bool ConfigAdmin::haveConfig(const char* config_id) const { return configuration_->has(text(config_id)); }
bool ConfigAdmin::isActive() const { return configuration_->is_active(); }
std::vector<std::string> ConfigAdmin::getParameterNames() const { return configuration_->bound_names(); }

std::vector<coil::Properties> ConfigAdmin::getConfigurationSets() const {
  std::vector<coil::Properties> nodes;
  for (const auto& set : configuration_->sets()) nodes.push_back(to_properties(set));
  return nodes;
}

coil::Properties ConfigAdmin::getConfigurationSet(const char* config_id) const {
  const auto set = configuration_->set(text(config_id));
  return set ? to_properties(*set) : coil::Properties();
}

coil::Properties ConfigAdmin::getActiveConfigurationSet() const { return getConfigurationSet(getActiveId()); }

bool ConfigAdmin::setConfigurationSetValues(const coil::Properties& config_set) {
  if (!configuration_->set_values(to_set(config_set))) return false;
  listeners_.configset_[static_cast<int>(ON_SET_CONFIG_SET)].notify(config_set);
  return true;
}

bool ConfigAdmin::addConfigurationSet(const coil::Properties& config_set) {
  if (!configuration_->add(to_set(config_set))) return false;
  listeners_.configset_[static_cast<int>(ON_ADD_CONFIG_SET)].notify(config_set);
  return true;
}

bool ConfigAdmin::removeConfigurationSet(const char* config_id) {
  if (!configuration_->remove(text(config_id))) return false;
  listeners_.configsetname_[static_cast<int>(ON_REMOVE_CONFIG_SET)].notify(config_id);
  return true;
}

bool ConfigAdmin::activateConfigurationSet(const char* config_id) {
  if (!configuration_->activate(text(config_id))) return false;
  listeners_.configsetname_[static_cast<int>(ON_ACTIVATE_CONFIG_SET)].notify(config_id);
  return true;
}

void ConfigAdmin::addConfigurationParamListener(ConfigurationParamListenerType type, ConfigurationParamListener* listener, bool autoclean) {
  if (type < CONFIG_PARAM_LISTENER_NUM) listeners_.configparam_[static_cast<int>(type)].addListener(listener, autoclean);
}
void ConfigAdmin::removeConfigurationParamListener(ConfigurationParamListenerType type, ConfigurationParamListener* listener) {
  if (type < CONFIG_PARAM_LISTENER_NUM) listeners_.configparam_[static_cast<int>(type)].removeListener(listener);
}
void ConfigAdmin::addConfigurationSetListener(ConfigurationSetListenerType type, ConfigurationSetListener* listener, bool autoclean) {
  if (type < CONFIG_SET_LISTENER_NUM) listeners_.configset_[static_cast<int>(type)].addListener(listener, autoclean);
}
void ConfigAdmin::removeConfigurationSetListener(ConfigurationSetListenerType type, ConfigurationSetListener* listener) {
  if (type < CONFIG_SET_LISTENER_NUM) listeners_.configset_[static_cast<int>(type)].removeListener(listener);
}
void ConfigAdmin::addConfigurationSetNameListener(ConfigurationSetNameListenerType type, ConfigurationSetNameListener* listener,
                                                  bool autoclean) {
  if (type < CONFIG_SET_NAME_LISTENER_NUM) listeners_.configsetname_[static_cast<int>(type)].addListener(listener, autoclean);
}
void ConfigAdmin::removeConfigurationSetNameListener(ConfigurationSetNameListenerType type, ConfigurationSetNameListener* listener) {
  if (type < CONFIG_SET_NAME_LISTENER_NUM) listeners_.configsetname_[static_cast<int>(type)].removeListener(listener);
}

}  // namespace RTC

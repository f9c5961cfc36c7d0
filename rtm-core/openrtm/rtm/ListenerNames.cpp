#include <rtm/ComponentActionListener.h>
#include <rtm/ConfigurationListener.h>

namespace RTC {

namespace {

template <std::size_t n, class Type>
const char* name_at(const char* const (&names)[n], Type type) {
  const auto i = static_cast<std::size_t>(type);
  return i < n ? names[i] : "";
}

}  // namespace

const char* PreComponentActionListener::toString(PreComponentActionListenerType type) {
  static const char* const names[] = {"PRE_ON_INITIALIZE", "PRE_ON_FINALIZE",    "PRE_ON_STARTUP",      "PRE_ON_SHUTDOWN",
                                      "PRE_ON_ACTIVATED",  "PRE_ON_DEACTIVATED", "PRE_ON_ABORTING",     "PRE_ON_ERROR",
                                      "PRE_ON_RESET",      "PRE_ON_EXECUTE",     "PRE_ON_STATE_UPDATE", "PRE_ON_RATE_CHANGED"};
  return name_at(names, type);
}

const char* PostComponentActionListener::toString(PostComponentActionListenerType type) {
  static const char* const names[] = {"POST_ON_INITIALIZE", "POST_ON_FINALIZE",    "POST_ON_STARTUP",      "POST_ON_SHUTDOWN",
                                      "POST_ON_ACTIVATED",  "POST_ON_DEACTIVATED", "POST_ON_ABORTING",     "POST_ON_ERROR",
                                      "POST_ON_RESET",      "POST_ON_EXECUTE",     "POST_ON_STATE_UPDATE", "POST_ON_RATE_CHANGED"};
  return name_at(names, type);
}

const char* PortActionListener::toString(PortActionListenerType type) {
  static const char* const names[] = {"ADD_PORT", "REMOVE_PORT"};
  return name_at(names, type);
}

const char* ExecutionContextActionListener::toString(ExecutionContextActionListenerType type) {
  static const char* const names[] = {"ATTACH_EC", "DETACH_EC"};
  return name_at(names, type);
}

const char* PreFsmActionListener::toString(PreFsmActionListenerType type) {
  static const char* const names[] = {"PRE_ON_INIT", "PRE_ON_ENTRY", "PRE_ON_DO", "PRE_ON_EXIT", "PRE_ON_STATE_CHANGE"};
  return name_at(names, type);
}

const char* PostFsmActionListener::toString(PostFsmActionListenerType type) {
  static const char* const names[] = {"POST_ON_INIT", "POST_ON_ENTRY", "POST_ON_DO", "POST_ON_EXIT", "POST_ON_STATE_CHANGE"};
  return name_at(names, type);
}

const char* ConfigurationParamListener::toString(ConfigurationParamListenerType type) {
  static const char* const names[] = {"ON_UPDATE_CONFIG_PARAM"};
  return name_at(names, type);
}

const char* ConfigurationSetListener::toString(ConfigurationSetListenerType type) {
  static const char* const names[] = {"ON_SET_CONFIG_SET", "ON_ADD_CONFIG_SET"};
  return name_at(names, type);
}

const char* ConfigurationSetNameListener::toString(ConfigurationSetNameListenerType type) {
  static const char* const names[] = {"ON_UPDATE_CONFIG_SET", "ON_REMOVE_CONFIG_SET", "ON_ACTIVATE_CONFIG_SET"};
  return name_at(names, type);
}

}  // namespace RTC

// See coil/Properties.h.
#pragma once

#include <rtm/Manager.h>
#include <rtm/idl/RTCSkel.h>

#include <string>

namespace RTC {

using UniqueId = ExecutionContextHandle_t;
class PortBase;
class InPortBase;
class OutPortBase;

class Logger {
 public:
  enum { RTL_ERROR, RTL_WARN, RTL_INFO };
  bool isValid(int level) const;
  void write(int level, const std::string& text);
};
std::string formatted(const char* format, ...);

enum class ConfigurationSetNameListenerType { ON_UPDATE_CONFIG_SET, ON_REMOVE_CONFIG_SET, ON_ACTIVATE_CONFIG_SET };
class ConfigurationSetNameListener;

class RTObject_impl {
 public:
  explicit RTObject_impl(Manager* manager);
  virtual ~RTObject_impl();

 protected:
  virtual ReturnCode_t onInitialize();
  virtual ReturnCode_t onFinalize();
  virtual ReturnCode_t onStartup(UniqueId exec_handle);
  virtual ReturnCode_t onShutdown(UniqueId exec_handle);
  virtual ReturnCode_t onActivated(UniqueId exec_handle);
  virtual ReturnCode_t onDeactivated(UniqueId exec_handle);
  virtual ReturnCode_t onExecute(UniqueId exec_handle);
  virtual ReturnCode_t onAborting(UniqueId exec_handle);
  virtual ReturnCode_t onError(UniqueId exec_handle);
  virtual ReturnCode_t onReset(UniqueId exec_handle);
  virtual ReturnCode_t onStateUpdate(UniqueId exec_handle);
  virtual ReturnCode_t onRateChanged(UniqueId exec_handle);

 public:
  bool addPort(PortBase& port);
  bool addInPort(const char* name, InPortBase& port);
  bool addOutPort(const char* name, OutPortBase& port);
  template <typename Variable>
  bool bindParameter(const char* name, Variable& variable, const char* default_value,
                     bool (*convert)(Variable&, const char*) = coil::stringTo) {
    return convert(variable, default_value) && name != nullptr;
  }
  template <class Listener>
  ConfigurationSetNameListener* addConfigurationSetNameListener(ConfigurationSetNameListenerType type, Listener& object,
                                                                void (Listener::*member)(const char*));
  const char* getInstanceName() const;

 protected:
  Logger rtclog;
};

class DataFlowComponentBase : public RTObject_impl {
 public:
  explicit DataFlowComponentBase(Manager* manager);
};

}  // namespace RTC

#define RTC_LIKE_LOG(level, words) \
  if (rtclog.isValid(level)) rtclog.write(level, ::RTC::formatted words)
#define RTC_ERROR(words) RTC_LIKE_LOG(::RTC::Logger::RTL_ERROR, words)
#define RTC_WARN(words) RTC_LIKE_LOG(::RTC::Logger::RTL_WARN, words)
#define RTC_INFO(words) RTC_LIKE_LOG(::RTC::Logger::RTL_INFO, words)

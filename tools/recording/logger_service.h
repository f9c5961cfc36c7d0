// Receives the log or the events of a component (OpenRTM::Logger), attached to it as a service profile. Messages arrive on threads of the
// ORB, one call at a time, and none after the end of the object. One thread at a time.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "rtm/idl/LoggerSkel.h"
#include "system/component_view.h"

namespace recorder {

class LoggerService final {
 public:
  using Take = std::function<void(const OpenRTM::LogRecord&)>;

  // Lines of its log from level info on, with simulated times where there is a simulation. Nothing for components that do not know such
  // services, and for those that do not answer.
  static std::unique_ptr<LoggerService> of_log(const tools::ComponentView& component, Take take);
  static std::unique_ptr<LoggerService> attach(const tools::ComponentView& component, const char* type, const tools::Properties& properties,
                                               Take take);
  ~LoggerService();  // asks the component to forget it
  LoggerService(const LoggerService&) = delete;
  LoggerService& operator=(const LoggerService&) = delete;

 private:
  class Servant;
  LoggerService(const tools::ComponentView& component, Take take);
  const RTC::RTObject_var component_;
  const std::string id_;
  PortableServer::Servant_var<Servant> servant_;
};

}  // namespace recorder

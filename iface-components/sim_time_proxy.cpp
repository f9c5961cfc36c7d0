#include "sim_time_proxy.h"

#include <base/clock.h>

#include <utility>

// clang-format off
static const char* const simtimeproxy_spec[] = {
    "implementation_id", "SimTimeProxy",
    "type_name", "SimTimeProxy",
    "description", "Takes part in simulated time for a component of another process",
    "version", "1.0.0",
    "vendor", "rtm-sim",
    "category", "simulation",
    "activity_type", "PERIODIC",
    "kind", "DataFlowComponent",
    "max_instance", "0",
    "language", "C++",
    "lang_type", "compile",
    "conf.default.ticks", "",
    ""};
// clang-format on

RTC::ReturnCode_t SimTimeProxy::onInitialize() {
  bindParameter("ticks", ticks_, "");
  return RTC::RTC_OK;
}

RTC::ReturnCode_t SimTimeProxy::onActivated(RTC::UniqueId) {
  ticked_.reset();
  said_.clear();
  if (ticks_.empty()) return RTC::RTC_OK;
  auto found = iface::TickedContext::resolve(RTC::Manager::instance().getORB(), ticks_);
  if (!found) {
    RTC_ERROR(("%s", found.error().message.c_str()));
    return RTC::RTC_ERROR;
  }
  ticked_ = std::move(*found);
  return RTC::RTC_OK;
}

RTC::ReturnCode_t SimTimeProxy::onDeactivated(RTC::UniqueId) {
  ticked_.reset();
  return RTC::RTC_OK;
}

RTC::ReturnCode_t SimTimeProxy::onExecute(RTC::UniqueId) {
  if (!ticked_) return RTC::RTC_OK;
  std::string why;
  switch (ticked_->tick(base::current_clock().now(), why)) {
    case iface::TickedContext::Answer::done:
      return RTC::RTC_OK;
    case iface::TickedContext::Answer::threw:
      if (std::exchange(said_, why) != why) RTC_WARN(("the context that is ticked throws: %s; it is ticked all the same", why.c_str()));
      return RTC::RTC_OK;
    case iface::TickedContext::Answer::gone:
      break;
  }
  RTC_ERROR(("the context that was ticked is gone: %s", why.c_str()));
  ticked_.reset();
  return RTC::RTC_ERROR;
}

extern "C" {
void SimTimeProxyInit(RTC::Manager* manager) {
  coil::Properties profile(simtimeproxy_spec);
  manager->registerFactory(profile, RTC::Create<SimTimeProxy>, RTC::Delete<SimTimeProxy>);
}
}

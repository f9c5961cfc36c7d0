// SimTimeProxy: brings a component of another process, of any maker, into simulated time. It owns the SimTimeContext in which that
// component takes part under its own name (exec_cxt.sim_time.participant), one proxy for each such component, so that several of one phase
// are called at the same time. `rtse join` and `rtse run` make them, and `rtse leave` ends them.
//
// The usual way, for any component: it becomes a member of the context (add_component), which calls its callbacks in each tick. The proxy
// itself then does nothing and stays inactive. The other way, for one whose own context must stay: configuration `ticks`, the reference of
// that context, which the proxy ticks while it is active (ticked_context.h). What that throws is passed over and said once; when it is gone
// the proxy ends in its error state, and a log line says so.
//
// Threads: those of every component.
#pragma once

#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <optional>
#include <string>

#include "ticked_context.h"

class SimTimeProxy : public RTC::DataFlowComponentBase {
 public:
  explicit SimTimeProxy(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  std::string ticks_;
  std::optional<iface::TickedContext> ticked_;
  std::string said_;
};

extern "C" {
DLL_EXPORT void SimTimeProxyInit(RTC::Manager* manager);
}

// SimTimeProxy: brings a component of another process, of any maker, into simulated time. It owns the SimTimeContext in which that
// component takes part under its own name (exec_cxt.sim_time.participant), one proxy for each such component, so that several of one phase
// are called at the same time. `rtse join` and `rtse run` make them, and `rtse leave` ends them.
//
// The usual way, for any component: it becomes a member of the context (add_component), which calls its callbacks in each tick. The proxy
// itself then does nothing and stays inactive. The other way, for one whose own context must stay: configuration `ticks`, the reference of
// that context, which the proxy ticks while it is active (ticked_context.h). What that throws is passed over and said once, and so is a
// tick that takes longer than a second; when the context was deleted the proxy ends in its error state, and a log line says so.
//
// Property sim_time_proxy.alone_limit [s]: an unused proxy, whose component's process has exited or whose object was deleted, exits after
// this time, and the last one ends its component host. The program that started it may have exited, and so may the simulator and the name
// server. A proxy that no component has joined yet waits as long as a start can take. Default: it stays.
//
// Threads: those of every component; the watch looks at long ticks, and asks whether the component still exists.
#pragma once

#include <base/guarded.h>
#include <rtm/DataFlowComponentBase.h>
#include <rtm/Manager.h>

#include <chrono>
#include <condition_variable>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ticked_context.h"

class SimTimeProxy : public RTC::DataFlowComponentBase {
 public:
  explicit SimTimeProxy(RTC::Manager* manager) : RTC::DataFlowComponentBase(manager) {}
  ~SimTimeProxy() override;
  RTC::ReturnCode_t onInitialize() override;
  RTC::ReturnCode_t onActivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onDeactivated(RTC::UniqueId ec_id) override;
  RTC::ReturnCode_t onExecute(RTC::UniqueId ec_id) override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Watched {
    std::string ticked;  // reference of the context that is ticked; empty: none
    std::optional<Clock::time_point> tick_since{};
    bool is_told = false;  // that this tick takes long
    bool is_ending = false;
  };
  void watch();
  bool is_alone();
  std::vector<std::string> joined();
  iface::TickedContext::Answer tick(std::string& why);

  std::string ticks_;
  std::optional<iface::TickedContext> ticked_;
  std::string said_;

  // Of the watch alone, once that runs.
  std::optional<std::chrono::nanoseconds> alone_limit_;
  std::chrono::nanoseconds timeout_{0};
  Clock::time_point served_at_, next_look_;

  base::Guarded<Watched, base::Rank::worker> watched_;
  std::condition_variable ending_;
  std::thread watch_;
};

extern "C" {
DLL_EXPORT void SimTimeProxyInit(RTC::Manager* manager);
}

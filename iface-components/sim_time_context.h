// SimTimeContext: an execution context on simulated time. It ticks its components at `rate` in simulated time and follows pause, step,
// reset and restart of the simulator; with `sim-server --lockstep` time passes only when the components have finished their tick.
//
// A component asks for it with `exec_cxt.periodic.type: SimTimeContext` (and `manager.modules.preload: SimTimeContext.so`). Options:
//   exec_cxt.sim_time.server_id   which simulator; default: $RTMSIM_SERVER_ID, else 0
//   exec_cxt.sim_time.phase       0 sensors, 1 clients (default), 2 actuators: phases run in order inside a tick
//   exec_cxt.member_timeout       how long a member of another process may take for a callback [s of real time]; default: 1, in lock step
//   30,
//                                 since its error would be part of the run
//
// Transitions happen in a tick, so that they are repeatable; while time stands still (paused, or waiting for participants) at once.
// Threads: the context's own thread ticks; everything else may be called from any thread.
#pragma once

#include <base/guarded.h>
#include <rtm/Manager.h>
#include <rtm/PeriodicExecutionContext.h>
#include <shm/lockstep.h>

#include <memory>
#include <string>

#include "sim_clock.h"
#include "simulator_time.h"

class SimTimeContext : public RTC::PeriodicExecutionContext {
 public:
  explicit SimTimeContext(const std::string& name = "SimTimeContext");
  ~SimTimeContext() override;

  void init(coil::Properties& properties) override;
  int svc() override;

 protected:
  RTC::ReturnCode_t onStopping() override;
  RTC::ReturnCode_t onSetRate(double rate) override;
  void onWakeUp() override;
  const base::Clock& contextClock() const override { return clock_; }
  std::shared_ptr<const base::Clock> sharedClock() const override { return simulator_time_; }

 private:
  std::shared_ptr<shm::Participant> join();
  void run(shm::Participant& participant);
  void interrupt();
  void say_once(const std::string& line);
  std::string participant_name() const;

  iface::SimClock clock_;  // the time of the tick that runs
  const std::shared_ptr<iface::SimulatorTime> simulator_time_ = std::make_shared<iface::SimulatorTime>();
  int server_id_ = 0;
  std::uint32_t phase_ = 1;
  bool waits_for_members_ = true;  // in lock step, as long as `rtse run` waits for a tick; false: the option member_timeout says how long
  std::string said_;               // the last line, not to be said again
  bool is_waiting_ = false;        // and has said so
  base::Guarded<std::shared_ptr<shm::Participant>, base::Rank::context> participant_;
};

extern "C" {
DLL_EXPORT void SimTimeContextInit(RTC::Manager* manager);
}

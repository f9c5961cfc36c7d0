// SimTimeContext: an execution context on simulated time. It ticks its components at `rate` in simulated time and follows pause, step,
// reset and restart of the simulator; with `sim-server --lockstep` time passes only when the components have finished their tick.
//
// A component asks for it with `exec_cxt.periodic.type: SimTimeContext` (and `manager.modules.preload: SimTimeContext.so`). Options:
//   exec_cxt.sim_time.server_id   which simulator; default: $RTMSIM_SERVER_ID, else 0
//   exec_cxt.sim_time.phase       0 sensors, 1 clients (default), 2 actuators: phases run in order inside a tick
//   exec_cxt.sim_time.turn        within the phase (0): higher turns are called when lower ones have finished; for third-party
//                                 components, which see input immediately (shm/lockstep.h)
//   exec_cxt.sim_time.participant name of the lock-step participant; default: that of its owner
//   exec_cxt.sim_time.hash_log    folder: a hash log of what the components read and write (base/hash_log.h) goes into a new file there
//   exec_cxt.sim_time.own_thread  NO: the contexts of a process with equal phase and rate share a thread that calls them one after another
//                                 (tick_group.h), as in a fleet. Default YES; those with `turn`, `participant` or `stack_size` have one
//   exec_cxt.member_timeout       how long a member of another process may take for a callback [s of real time]; default: 1, in lock step
//                                 without end, since its error would be part of the run
//
// Members may be components of other processes and of any maker: they join and leave by add_component and remove_component, and
// are called in the tick of this context, in its phase, whatever their own contexts do. Rights and failures:
// corba/members/remote_participant.h.
//
// In lock step what components write in a phase can be read in later phases only (base/tick.h), and what they send with subscription `new`
// or `periodic` is sent at the end of their tick.
//
// Transitions happen in a tick, so that they are repeatable; while time stands still (paused, or waiting for participants) at once.
// Threads: the context's own thread joins the lock step, and ticks, or lets the group tick; everything else may be called from any thread.
#pragma once

#include <base/clock.h>
#include <base/guarded.h>
#include <rtm/Manager.h>
#include <rtm/PeriodicExecutionContext.h>
#include <shm/lockstep.h>

#include <memory>
#include <string>

#include "sim_tick.h"
#include "simulator_time.h"
#include "tick_group.h"

class SimTimeContext : public RTC::PeriodicExecutionContext, private iface::TickGroup::Ticked {
 public:
  explicit SimTimeContext(const std::string& name = "SimTimeContext");
  ~SimTimeContext() override;

  void init(coil::Properties& properties) override;
  int svc() override;

 protected:
  RTC::ReturnCode_t onSetRate(double rate) override;
  void onWakeUp() override;

 private:
  std::shared_ptr<shm::Participant> join();
  void run(const std::shared_ptr<shm::Participant>& participant);
  shm::Participant::State run_alone(shm::Participant& participant);
  shm::Participant::State run_in_group(const std::shared_ptr<shm::Participant>& participant);
  void run_tick(const shm::Tick& tick) override;
  void run_requests() override;
  void report_long_call() override;
  std::uint64_t hash_of_states() const;
  void interrupt();
  void say_once(const std::string& line);
  std::string participant_name() const;

  const std::shared_ptr<base::ManualClock> clock_ = std::make_shared<base::ManualClock>();  // the time of the tick that runs
  const std::shared_ptr<iface::SimulatorTime> simulator_time_ = std::make_shared<iface::SimulatorTime>();
  int server_id_ = 0;
  std::uint32_t phase_ = 1, turn_ = 0;
  std::string participant_as_;     // empty: the owner's name
  bool waits_for_members_ = true;  // in lock step, for ever; false: the option member_timeout says how long
  bool has_own_thread_ = true;     // else it is ticked by a group
  SimTick tick_;                   // of the thread that ticks
  std::string hash_log_;           // where it is still to be made
  std::string said_;               // the last line, not to be said again
  bool is_waiting_ = false;        // and has said so
  base::Guarded<std::shared_ptr<shm::Participant>, base::Rank::context> participant_;
  base::Guarded<iface::TickGroup::Place*, base::Rank::context> place_;  // in the group, while there is one
};

extern "C" {
DLL_EXPORT void SimTimeContextInit(RTC::Manager* manager);
}

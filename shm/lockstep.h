// Lock step: simulated time that waits for processes. `Barrier` is the server's side (the stepping thread only, except where said),
// `Participant` a client's (one thread at a time).
//
// States of a participant's slot, and who may change what:
//
//   free ──(client: takes the slot, writes name, phase, period)──> joining ──(server, between ticks)──> active
//   active ──(client)──> leaving ──(server)──> free          active, joining ──(server: dead, hung, refused)──> dropped ──(client, or
//   server when the process is dead)──> free
//
// Rights: the client writes owner, phase, period, name, done and `joining`, `leaving`; the server writes go, now and the statistics and
// `active`, `dropped`, `free`. The server keeps private copies of everything it needs; what a client scribbles can at worst make its own
// tick count as finished, or cost the server one waiting slice (10 ms).
//
// A tick at time t: for each phase in ascending order, and within it for each turn, the server releases all participants of that phase and
// turn that are due (go = tick number) and wakes them with one system call, and waits until each has stored done = go. No other
// participant is woken: sleepers share a futex word and are told apart by its bit sets. Due times are the multiples of the period since
// time 0, so they do not depend on when a participant joined; a tick happens at the first step at or after the due time, without drift.
//
// Observers (those that only look at samples, as recorders do) come after all phases and are not waited for at the end of the tick, but
// before the next samples are written, the next tick of any participant, and anything else that may change the samples: settle(). So they
// read while the next steps are computed, and see what they would have seen in their tick. The clock is that of the tick (Tick::now): the
// one that is published, and what the server is asked for, may be of a later step. Without lock step they are as all others.
//
//   active ──(server: tick is due)──> reads ──(client: done, left, dead; server: dropped)──> active, or removed
//
// Failures:
//   observer dies, hangs, leaves       as below; settle() goes on without it
//   dies at any point                  its slot is taken back at once (pid watch); the tick goes on without it
//   hangs (stopped, endless loop)      named after one second, once per hang; dropped after participant_timeout when there is one
//   stopped, dropped, then continued   its wait() says dropped; it may join again
//   server dies                        wait() says closed within a tenth of a second; join again when it is back
//   joins while a tick runs            takes part from the next tick on; leaves: at once
//   joins without end                  refused when all slots are taken, with a message
//
// The beginnings and ends of phases are counted (`moment`, odd while a phase runs), for the rule by which data is delivered: what is
// written in a phase is read in later ones (base/tick.h). All turns of a phase are one moment: turns are for those who cannot keep that
// rule, because they hold what they get at once.
//
// Participants sleep on a few shared futex words told apart by bits, so that one system call wakes a whole phase.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "shm/client.h"
#include "shm/server.h"

namespace shm {

struct BarrierEvent {
  enum class Kind { joined, left, died, hangs, dropped } kind;
  std::string name;
  pid_t pid = 0;
  std::uint32_t phase = 0;
  std::int64_t period_ns = 0;
  bool looks_on = false;
  bool was_in_tick = false;  // died: before it had finished the tick that runs
};

struct BarrierOptions {
  // false: participants are woken when due, but time does not wait for them.
  bool is_lockstep = true;
  std::chrono::nanoseconds hang_warning = std::chrono::seconds(1);
  std::chrono::nanoseconds participant_timeout = std::chrono::nanoseconds(0);  // 0 = never dropped
  // Called from the stepping thread.
  std::function<void(const BarrierEvent&)> on_event;
  // Called at least ten times a second while a tick waits; false ends the tick early (the server is asked to end). Of the barrier
  // it may call records() and drop().
  std::function<bool()> on_waiting;
};

// One participant, for people; also read by clients.
struct ParticipantRecord {
  std::string name;
  pid_t pid = 0;
  std::uint32_t phase = 0;
  std::int64_t period_ns = 0;
  std::uint64_t ticks = 0, missed = 0;
  std::int64_t mean_ns = 0, max_ns = 0;  // wall time per tick
  bool is_active = false;
  bool is_late = false;  // has not finished its current tick
};

// One per server. Its end tells the participants that the simulation is closed.
class Barrier {
 public:
  Barrier(IfaceWriter& simulation, Server& server, BarrierOptions options);
  ~Barrier();

  // Takes in who has joined and lets go who has left; also done by tick(). Returns the number of active participants.
  std::size_t refresh();
  // Runs all phases for the participants due at `now`, and lets the observers begin. Cheap when nobody is due. False when on_waiting
  // ended it.
  bool tick(std::chrono::nanoseconds now, std::uint64_t steps);
  // Waits for the observers of the last tick; to be called before samples are written, and before requests change anything. tick() does
  // so itself. Cheap when nobody looks. False when on_waiting ended it.
  bool settle();
  // Earliest time at which anybody is due, if anybody is there.
  std::optional<std::chrono::nanoseconds> next_due() const;
  // Whether anybody is called at `now` who does not only look on; nothing when there is nobody.
  std::optional<bool> has_turn(std::chrono::nanoseconds now);
  // After a reset or another jump of time: due times start again at the first multiple of each period at or after `now`.
  void rewind(std::chrono::nanoseconds now, std::uint32_t resets);
  // All participants with this name; false when there is none.
  bool drop(const std::string& name);
  std::vector<ParticipantRecord> records() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

struct ParticipantOptions {
  std::string name;
  std::uint32_t phase = 1;                                          // 0 sensors, 1 clients, 2 actuators; at most 15
  std::chrono::nanoseconds period = std::chrono::milliseconds(10);  // 0: every step
  std::uint32_t turn = 0;                                           // within the phase: higher ones begin when lower ones have finished
  bool looks_on = false;  // a tool, no part of what is simulated: who it is and when it comes is no part of what a run did
  bool observes = false;  // only looks at what the simulator shows: time need not wait for it at once; the phase does not matter
};

struct Tick {
  std::chrono::nanoseconds now{0};  // simulated
  std::chrono::nanoseconds due{0};
  std::uint64_t steps = 0;
  std::uint32_t resets = 0;  // differs from the last tick's after a reset
  std::uint64_t moment = 0;  // odd: the phase that runs; 0: time does not wait
};

class Participant {
 public:
  // Takes a slot. Returns at once; the server takes it in between two ticks.
  static base::Result<Participant> join(std::uint32_t server_id, const ParticipantOptions& options);
  Participant(Participant&&) noexcept;
  Participant& operator=(Participant&&) noexcept;
  ~Participant();  // leaves

  enum class State { tick, timed_out, dropped, closed };
  // Says that the last tick is done, if there was one, and waits for the next. After dropped or closed: join again.
  State wait(Tick& tick, std::chrono::nanoseconds timeout);
  // The halves of wait(), for a thread that serves several participants (iface-components/tick_group.h). await() is wait(), but a tick that
  // it reports begins with begin(). look() says without waiting whether there is one; timed_out: none.
  State await(std::chrono::nanoseconds timeout);
  State look() const;
  Tick begin();
  // The tick is done; for those who have other things to do before they wait again.
  void finish();
  void set_period(std::chrono::nanoseconds period);
  void set_observing(bool observes);
  bool is_active() const;
  // Wakes a wait() in another thread: it returns timed_out. Any thread.
  void interrupt();

 private:
  struct Impl;
  explicit Participant(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

// 0: nothing runs in lock step there. Any thread.
std::uint64_t moment_of(const Iface& simulation);

// All participants of a server's simulation, by a client.
base::Result<std::vector<ParticipantRecord>> read_participants(const Iface& simulation);

}  // namespace shm

// Lock step: simulated time waits for the processes that take part. `Barrier` is the side of the simulator (the stepping thread only,
// except where stated). `Participant` is the side of a client (one thread at a time).
//
// States of a participant's slot, and which side changes them ("server" is the simulator):
//
//   free    ──(client: acquires the slot, writes name, phase, period)──> joining
//   joining ──(server, between ticks)──> active
//   active  ──(client)──> leaving ──(server)──> free
//   active, joining ──(server: dead, hung, rejected)──> dropped ──(client, or server if the process is dead)──> free
//
// Rights: the client writes owner, phase, period, name and done, and sets `joining` and `leaving`. The server writes go, now and the
// statistics, and sets `active`, `dropped` and `free`. The server keeps private copies of all values it needs. So invalid writes of a
// client can only end its own tick early, or delay the server by one wait (10 ms).
//
// A tick at time t: the server handles the phases in ascending order, and within a phase the values of `turn` (the call order). For each of
// them it releases all due participants (go = tick number), wakes them with one system call, and waits until each has stored done = go. No
// other participant is woken. Due times are the multiples of the period since time 0, so they do not depend on the time of joining. A tick
// happens at the first step at or after its due time, so it does not drift.
//
// Observers, such as recorders, only read samples. They run after all phases. The server waits for them in settle(): before the next
// samples are written, before the next tick of any participant, and before any other change of the samples. So observers read while the
// next steps are computed, and see the samples of their tick. Tick::now is the time of that tick; the published clock, and replies of the
// server, can be of a later step. Without lock step, observers are like all other participants.
//
//   active ──(server: tick is due)──> reads ──(client: done, left, dead; server: dropped)──> active, or removed
//
// Failures:
//   observer dies, hangs, leaves       like other participants; settle() continues without it
//   dies at any time                   its slot is released at once (pid watch); the tick continues without it
//   hangs (stopped, endless loop)      reported after one second, once per hang; dropped after participant_timeout, if that is set
//   stopped, dropped, then continued   its wait() returns dropped; it can join again
//   server dies                        wait() returns closed within a tenth of a second; join again when a server is back
//   joins during a tick                takes part from the next tick on. Leaving takes effect at once
//   too many participants              rejected with a message when all slots are in use
//
// The phase counter counts starts and ends of phases; it is odd while a phase runs. Delivery of data depends on it: data that is written in
// a phase is read in later phases (base/tick.h). All values of `turn` in a phase have the same phase counter. `turn` is for programs that
// use data as soon as they receive it, so that the delivery rule does not apply to them.
//
// Participants sleep on a few shared futex words, one bit each, so that one system call wakes a whole phase.
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
  bool is_tool = false;
  bool was_in_tick = false;  // died: before it finished the running tick
};

struct BarrierOptions {
  // false: participants are woken when due, but time does not wait for them.
  bool is_lockstep = true;
  std::chrono::nanoseconds hang_warning = std::chrono::seconds(1);
  std::chrono::nanoseconds participant_timeout = std::chrono::nanoseconds(0);  // 0 = never dropped
  // Called from the stepping thread.
  std::function<void(const BarrierEvent&)> on_event;
  // Called at least ten times a second while a tick waits. False ends the tick early, because the server shall end. It may call records()
  // and drop() of the barrier.
  std::function<bool()> on_waiting;
};

// One participant, for display. Clients can read it, too.
struct ParticipantRecord {
  std::string name;
  pid_t pid = 0;
  std::uint32_t phase = 0;
  std::int64_t period_ns = 0;
  std::uint64_t ticks = 0, missed = 0;
  std::int64_t mean_ns = 0, max_ns = 0;  // wall-clock time per tick
  bool is_active = false;
  bool is_late = false;  // has not finished its current tick
};

// One per server. Its destructor closes the simulation for the participants.
class Barrier {
 public:
  Barrier(IfaceWriter& simulation, Server& server, BarrierOptions options);
  ~Barrier();

  // Adds participants that joined, and removes those that left. tick() does this, too. Returns the number of active participants.
  std::size_t refresh();
  // Runs all phases for the participants that are due at `now`, then starts the observers. Cheap if none is due. False if on_waiting ended
  // it.
  bool tick(std::chrono::nanoseconds now, std::uint64_t steps);
  // Waits for the observers of the last tick. Call it before samples are written and before requests change anything; tick() calls it.
  // Cheap without observers. False if on_waiting ended it.
  bool settle();
  // The earliest due time; nothing without participants.
  std::optional<std::chrono::nanoseconds> next_due() const;
  // True if a participant other than observers and tools is due at `now`. Nothing if there is no such participant.
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
  std::uint32_t turn = 0;  // call order in the phase: higher ones begin when lower ones have finished
  bool is_tool = false;    // a tool, not part of the simulated system: joining and leaving are not part of the result of a run
  bool observes = false;   // an observer; its phase does not matter
};

struct Tick {
  std::chrono::nanoseconds now{0};  // simulated
  std::chrono::nanoseconds due{0};
  std::uint64_t steps = 0;
  std::uint32_t resets = 0;         // differs from the last tick's after a reset
  std::uint64_t phase_counter = 0;  // odd: the phase that runs; 0: time does not wait
};

class Participant {
 public:
  // Acquires a slot. Returns at once; the server adds the participant between two ticks.
  static base::Result<Participant> join(std::uint32_t server_id, const ParticipantOptions& options);
  Participant(Participant&&) noexcept;
  Participant& operator=(Participant&&) noexcept;
  ~Participant();  // leaves

  enum class State { tick, timed_out, dropped, closed };
  // Reports the last tick as done, if there was one, and waits for the next. After dropped or closed: join again.
  State wait(Tick& tick, std::chrono::nanoseconds timeout);
  // The parts of wait(), for a thread that serves several participants (iface-components/tick_group.h). await() is like wait(), but its
  // tick starts with begin(). look() checks for a tick without waiting; timed_out: none.
  State await(std::chrono::nanoseconds timeout);
  State look() const;
  Tick begin();
  // Reports the tick as done, for callers that do other work before the next wait().
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

// The phase counter; 0 without lock step. Any thread.
std::uint64_t phase_counter_of(const Iface& simulation);

// For clients: all participants of the simulation.
base::Result<std::vector<ParticipantRecord>> read_participants(const Iface& simulation);

}  // namespace shm

// An execution context without a thread: its members, their states, the requested transitions, and the three stages of a cycle.
// step() and the stages belong to one thread at a time, the stepping thread; with lanes, each lane has one. Members of other processes are
// called on further threads of its own (Participant::place); a stage ends when all of them have returned. A second thread (contexts of
// authors have them) may make a member be called twice at the same time, and does no other harm. Everything else may be called from any
// thread. No lock is held while a participant is called.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "base/guarded.h"
#include "core/lifecycle.h"
#include "core/return_code.h"

namespace rt {

// Never used again after a member has left; 0 is no member.
using MemberId = std::uint64_t;

// What a context calls, and the one place where it is kept who is a member.
class Participant {
 public:
  virtual ~Participant() = default;
  // Called once, before the member is visible to other threads.
  virtual void joined(MemberId) {}
  // For messages.
  virtual std::string name() const = 0;
  // Any exception counts as an error and is logged.
  virtual ReturnCode call(Action action) = 0;
  // Where it is called: empty for this process. Members of several other places that stand side by side among the members are called at the
  // same time, each place on a thread of the context's (of 64, if there are more places); those of one place, and all others, one after
  // another in the order in which they joined.
  virtual std::string place() const { return {}; }
};

struct ContextStatistics {
  std::uint64_t cycles = 0;
  std::uint64_t missed_cycles = 0;
  std::chrono::nanoseconds total_execution{0};
  std::chrono::nanoseconds max_execution{0};
  std::chrono::nanoseconds total_waiting{0};  // of callbacks for others (base/waiting.h), beside the time of execution
  std::chrono::nanoseconds mean_execution() const {
    return cycles == 0 ? std::chrono::nanoseconds(0) : total_execution / static_cast<std::int64_t>(cycles);
  }
  std::chrono::nanoseconds mean_waiting() const {
    return cycles == 0 ? std::chrono::nanoseconds(0) : total_waiting / static_cast<std::int64_t>(cycles);
  }
};

class ParallelCalls;

class ExecutionContext {
 public:
  struct MemberState {
    MemberId id;
    State state;
    State next;  // where the pending request leads, else the state
  };

  // Rates outside are rejected [Hz].
  static constexpr double min_rate = 1e-6;
  static constexpr double max_rate = 1e6;

  // The name is for messages.
  explicit ExecutionContext(std::string name = "execution context", double rate = 1000.0);

  bool is_running() const;
  bool is_halted() const;
  // Call every member's startup (shutdown) action. Fail when it runs (is stopped) already. After stop() has succeeded no stage calls
  // a member. It waits for a call that runs on another thread; when that does not return in time the answer is error and it runs on.
  ReturnCode start();
  ReturnCode stop(std::chrono::nanoseconds timeout = std::chrono::seconds(60));
  // Between halt() and resume() no stage starts a call, so that a quiet context stays quiet.
  void halt();
  void resume();

  double rate() const;
  std::chrono::nanoseconds period() const;
  // Takes effect from the next cycle on; calls every member's rate_changed.
  ReturnCode set_rate(double rate);

  // Members are stepped lane by lane; lanes may be stepped at the same time. One, number 0, unless this is called before the first step.
  void set_lanes(std::size_t count);
  // A new member is inactive and takes part from the next cycle on. A lane that does not exist is the first.
  MemberId add(std::shared_ptr<Participant> participant, std::size_t lane = 0);
  // Waits until the member is not being called on another thread; it is not called again even when the time is over before. Without a call
  // in progress the participant is released at once.
  enum class Removal { no_member, left_alone, still_called };
  Removal remove(MemberId id, std::chrono::nanoseconds timeout = std::chrono::seconds(60));
  std::vector<MemberState> members() const;
  // In the order in which they joined.
  std::vector<std::shared_ptr<Participant>> participants() const;
  // State::created if it is not a member.
  State state(MemberId id) const;
  State next_state(MemberId id) const;
  bool is_next(State state) const;  // all members will be in that state

  // Requests a transition for the next first stage. Returns bad_parameter if the component is not a member, precondition_not_met if its
  // state does not allow the transition or another one is pending.
  ReturnCode request(MemberId id, Event event);
  // Waits for the end of a request: precondition_not_met when it ended in another state than asked for, error when the time is over.
  // On the stepping thread it returns ok at once.
  ReturnCode wait(MemberId id, Event event, std::chrono::nanoseconds timeout);
  // As wait(), but error also as soon as the context is stopped, since no transition comes then.
  ReturnCode wait_while_running(MemberId id, Event event, std::chrono::nanoseconds timeout);
  // Waits until no member is called on another thread; false after a timeout.
  bool wait_until_quiet(std::chrono::nanoseconds timeout);
  // No thread waits for the current call any more: remove() and wait_until_quiet() fail at once as long as it lasts.
  void write_off_call();
  // The call that is written off and still runs, as "Arm0 in onExecute".
  std::optional<std::string> stuck_call() const;

  // Called after every request and change of rate, so that a worker wakes up. Set it before other threads use the context.
  void on_wake(std::function<void()> wake) { wake_ = std::move(wake); }
  // No member is active, in error or about to change: there is nothing to step.
  bool is_idle() const;

  // The stages: transitions; execute (error); state update. They do nothing while the context is stopped.
  // A cycle is counted at the end of lane 0.
  void transit(std::size_t lane = 0);
  void execute(std::size_t lane = 0);
  void update(std::size_t lane = 0);
  // The same for one member, for contexts that choose the order themselves; nothing happens if it is not a member.
  void transit_one(MemberId id);
  void execute_one(MemberId id);
  void update_one(MemberId id);
  void step() {
    transit();
    execute();
    update();
  }
  // True inside a call to a participant on this thread.
  bool is_stepping_thread() const;

  ContextStatistics statistics() const;
  void count_missed(std::uint64_t cycles);
  // For cycles of transit_one and its relatives.
  void count_cycle(std::chrono::nanoseconds took, std::chrono::nanoseconds waited = std::chrono::nanoseconds(0));

 private:
  ReturnCode wait_until_settled(MemberId id, Event event, std::chrono::nanoseconds timeout, bool gives_up_when_stopped);
  struct Member {
    MemberId id;
    std::shared_ptr<Participant> participant;
    std::size_t lane = 0;
    State state = State::inactive;
    std::optional<Event> pending{};
    bool removed = false;
  };
  // One after another; at the same time; one after another. A stage keeps the plan it began with.
  using Group = std::vector<std::shared_ptr<Member>>;
  using Stage = std::vector<Group>;
  struct Plan {
    std::vector<Stage> stages{};
    std::shared_ptr<ParallelCalls> parallel_calls{};  // when a stage has several groups; the plan's own
  };
  using Members = std::shared_ptr<const Plan>;
  struct Lane {
    Members members = std::make_shared<const Plan>();
    std::uint64_t version = 0;
    std::chrono::steady_clock::time_point cycle_start{};
    std::chrono::nanoseconds waited_before{0};  // by its thread
  };
  // Of a stepping thread to a member.
  struct Call {
    MemberId member;
    const Participant* callee;
    Action action;
    std::thread::id caller;
    bool is_written_off;
    bool is_own() const { return caller == std::this_thread::get_id(); }
  };
  struct Data {
    bool running = false;
    bool halted = false;
    double rate = 1000.0;
    MemberId last_id = 0;
    std::vector<std::shared_ptr<Member>> members{};
    std::uint64_t version = 0;  // of members
    std::vector<Call> calls{};  // in progress
    ContextStatistics statistics{};
    std::vector<Lane> lanes = std::vector<Lane>(1);
  };
  static bool may_call(const Data& data) { return data.running && !data.halted; }
  using Shared = base::Guarded<Data, base::Rank::context>;

  static Member* find(Data& data, MemberId id);
  static const Member* find(const Data& data, MemberId id);
  static State next(const Member& member);
  ReturnCode call(const Participant& participant, Action action) const;
  void call_all(Action action);
  // Calls the member and lists the call as in progress. Nothing if the member has left or the context is stopped; then there is no call.
  std::optional<ReturnCode> call_member(Member& member, Action action);
  Members begin_cycle(std::size_t lane);
  Members plan(const Group& members) const;
  static void for_all(const Plan& plan, const std::function<void(Member&)>& call);
  Members members_of(std::size_t lane) const;
  std::shared_ptr<Member> hold(MemberId id) const;
  void transit(Member& member);
  // One stage of a cycle for one member: execute or state update, by its state.
  template <class Select>
  void run_stage(Member& member, Select select);

  const std::string name_;
  std::function<void()> wake_;
  Shared shared_;
  std::condition_variable changed_;
};

}  // namespace rt

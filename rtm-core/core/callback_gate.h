// The gate before the callbacks of one component: one thread at a time is inside, for all callers. Any thread.
//
// States of a thread:
//   outside -> inside     at once while no thread is inside or waits, or if the thread itself is inside (a callback that calls another)
//   outside -> waiting    otherwise; threads enter in the order in which they came
//   waiting -> inside     when the one inside has left
//   waiting -> outside    rejected: see below
// Rights: a thread inside runs the author's code without a lock, and leaves on the same thread. `Caller::remote` are calls from other
// processes, `Caller::local` all others.
// Failures, each an answer to the thread that wanted to enter:
//   busy      the one inside did not leave in time, or has been given up
//   crowded   `max_waiting` remote callers wait already
//   closed    the gate is closed to remote callers; waiting ones are answered at once
// A callback that does not return can be given up: from then on no thread waits for it. It stays inside until it returns.
//
// A thread that waits here can be inside another gate, and a thread inside here can wait for that gate. The first timeout ends such a
// cycle.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <thread>
#include <vector>

#include "base/guarded.h"

namespace rt {

class CallbackGate {
 public:
  enum class Caller { local, remote };
  enum class Answer { inside, busy, crowded, closed };
  // A callback that runs.
  struct Running {
    const char* callback;
    std::chrono::steady_clock::time_point since;
    std::thread::id thread;
    bool is_given_up;  // it did not return in time; nobody waits for it
  };
  static constexpr std::size_t max_waiting = 64;

  // Inside for its life, if the answer is so. Name of the callback: a literal.
  class Visit {
   public:
    // Enters at once; otherwise the answer is busy or closed, and wait() may be called.
    Visit(CallbackGate& gate, const char* callback, Caller caller);
    ~Visit();
    Visit(const Visit&) = delete;
    Visit& operator=(const Visit&) = delete;
    Answer answer() const { return answer_; }
    // Enters before `deadline`, or not.
    Answer wait(std::chrono::steady_clock::time_point deadline);

   private:
    CallbackGate& gate_;
    const char* const callback_;
    const Caller caller_;
    Answer answer_;
  };

  // The calling thread runs a callback of this component.
  bool is_inside() const;
  // Remote callers are rejected from now on.
  void close_to_remote();
  // Waits until those who are inside, and those who wait now, have left; at once on a thread that is inside. After `deadline` it gives up
  // those who are inside, and answers false; also at once if one has been given up before.
  bool wait_until_empty(std::chrono::steady_clock::time_point deadline);
  // On all threads; those of the calling thread are left out by others_inside().
  std::vector<Running> inside() const { return state_.lock()->inside; }
  std::vector<Running> others_inside() const;
  // "onExecute has run for 0.5 s", of another thread; "" if none is inside.
  std::string describe() const;

 private:
  struct State {
    std::vector<Running> inside{};
    std::deque<std::uint64_t> waiting{};  // tickets, first come first
    std::uint64_t last_ticket = 0;
    std::size_t remote_waiting = 0;
    bool is_closed_to_remote = false;
  };
  using Shared = base::Guarded<State, base::Rank::callbacks>;

  static bool is_free(const State& state);
  static bool has_given_up(const State& state);
  static void push(State& state, const char* callback);
  Answer enter(const char* callback, Caller caller);
  Answer wait(const char* callback, Caller caller, std::chrono::steady_clock::time_point deadline);
  void leave();

  Shared state_;
  std::condition_variable changed_;  // with the lock of state_
};

}  // namespace rt

// The contexts of a process that are ticked together: same simulator, phase and period. Each is a participant of its own in the lock step,
// with its own name and statistics, but one thread sleeps for all of them, is woken once a tick, and calls them one after another. So a
// host of a hundred small components costs a few wake-ups a tick instead of a hundred.
//
// The order of the calls changes nothing, since what is written in a phase is read in later ones (base/tick.h).
//
// Threads. One thread waits for the next tick and calls the contexts that are due. Further threads help:
//   the calls of the last tick took longer than `worth_sharing`   as many as there are processors
//   a call does not return within 20 ms: it is slow, hangs,       another thread calls the others, and waits for the next tick. The group
//   or waits for another component                                keeps it for the next tick that takes long
// A context is called by one thread at a time, and not always by the same.
//
// States of a place: present -> called -> present; over when its participant was dropped or its simulator has exited. The group reports
// that to wait(), and calls it no more.
//
// A place ends when its context is not called: a call that hangs would still use the context. After `long_wait` the context reports which
// component that is, once; the end goes on waiting. The process ends all the same (manager/end.cpp).
#pragma once

#include <shm/lockstep.h>

#include <chrono>
#include <cstdint>
#include <memory>

namespace iface {

class TickGroup {
 public:
  static constexpr std::chrono::seconds long_wait{1};

  // What a context does in a tick, and for requests while time stands still. On a thread of the group.
  class Ticked {
   public:
    virtual ~Ticked() = default;
    virtual void run_tick(const shm::Tick& tick) = 0;
    virtual void run_requests() = 0;
    // Its place is to end, and the call has not returned for `long_wait`. On the thread that ends the place, which goes on waiting.
    virtual void report_long_call() = 0;
  };
  struct Key {
    int server_id = 0;
    std::uint32_t phase = 1;
    std::chrono::nanoseconds period{0};
    auto operator<=>(const Key&) const = default;
  };

  // The place of one context in the group of its key. Made, awaited and destroyed by one thread, which no callback may be.
  class Place {
   public:
    Place(const Key& key, std::shared_ptr<shm::Participant> participant, Ticked& ticked);
    // Waits until the context is not called any more (above).
    ~Place();
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

    // Until the participant is dropped or closed, or leave() was called: timed_out.
    shm::Participant::State wait();
    // The context has requests. Any thread, also a callback.
    void wake();
    // Ends wait(). Any thread, also a callback.
    void leave();

   private:
    struct Node;
    friend class TickGroup;
    const std::shared_ptr<TickGroup> group_;
    const std::shared_ptr<Node> node_;
  };

  ~TickGroup();
  TickGroup(const TickGroup&) = delete;
  TickGroup& operator=(const TickGroup&) = delete;

 private:
  TickGroup();
  static std::shared_ptr<TickGroup> of(const Key& key);
  struct Impl;
  const std::unique_ptr<Impl> impl_;
};

}  // namespace iface

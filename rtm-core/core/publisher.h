// Sends the samples of one connection on a thread of its own: at once (subscription `new`) or periodically. Any
// thread.
//
// Samples that are written in a tick of a lock step (base/tick.h) are sent on the thread of the tick after its callbacks, by the same
// policies: with `new` at once, with `periodic` at the ends of those ticks that are the first at or after a multiple of the period in
// simulated time. A receiver that is full is tried again at the end of the next tick. So a run never depends on the publisher's thread.
#pragma once

#include <functional>
#include <memory>
#include <thread>

#include "core/connector_settings.h"
#include "core/mailbox.h"
#include "core/port_status.h"
#include "core/steady_time.h"

namespace base {
class Tick;
}

namespace rt {

class Publisher {
 public:
  // Called on the publisher's thread, without locks. May stop the publisher.
  struct Hooks {
    // send_full and send_timeout: the sample is sent again later; connection_lost: nothing more is sent.
    std::function<PortStatus(const Sample&)> send;
    // Its time has come and there is nothing to send (periodic only).
    std::function<void()> starved;
    // After send has reported connection_lost.
    std::function<void()> lost;
  };

  // `subscription` is not flush. The thread ends with the publisher, or, when that
  // happens during a hook, soon afterwards; the hooks live as long as the thread.
  Publisher(Subscription subscription, const PublisherSettings& publisher, const BufferSettings& buffer, Hooks hooks,
            const SteadyTime& time = machine_time());
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  // status: ok, buffer_full, buffer_timeout; connection_lost or precondition_not_met once it does not send any more.
  // `tick`: of the calling thread, when what is written belongs to it. A full queue is sent first then; nobody waits for room.
  WriteResult write(Sample sample, base::Tick* tick = nullptr);
  // Samples that wait to be sent.
  std::size_t waiting() const;
  void drop_waiting();
  // Samples that are not sent yet are dropped. Does not wait for one that is being sent: a peer that hangs must not hang others.
  void stop();

 private:
  struct Work;
  WriteResult write_in(base::Tick& tick, Sample sample);
  // True if the thread is in a hook.
  bool request_stop();
  std::shared_ptr<Work> work_;
  std::shared_ptr<void> jump_;  // wakes the work
  std::thread thread_;
};

}  // namespace rt

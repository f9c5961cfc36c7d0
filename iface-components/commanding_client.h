// The handle that commands a robot; its end stops the robot. Any thread.
// In real time a velocity goes to the robot on the thread that brings it; in simulated time the component hands it on in its own phase.
#pragma once

#include <base/guarded.h>

#include <atomic>
#include <span>

#include "iface_link.h"

namespace iface {

class CommandingClient {
 public:
  CommandingClient(shm::IfaceType type, Say say);

  base::Result<void> attach(const Device& device);
  void detach();

  // A velocity (or another command of that kind) has come, in the order of the iface's command values. Drives at once in real time.
  void received(std::span<const double> velocity, shm::CommandKind kind = shm::CommandKind::velocity);
  void drive(std::span<const double> velocity, shm::CommandKind kind = shm::CommandKind::velocity);
  // True when the robot had been driven.
  bool stop();
  // False: the simulator has been reset, or is another one, since the newest velocity came. A context of this process has thrown it away
  // then; one of another process, which calls a component here, cannot.
  bool is_newest_of_this_run();
  // Velocities so far.
  std::uint64_t arrivals() const { return arrivals_.load(std::memory_order_acquire); }  // pairs with the addition in received
  void set_simulated_time(bool simulated) { in_simulated_time_.store(simulated, std::memory_order_release); }  // pairs with received

 private:
  // Which simulator, and how often it has been reset.
  struct Run {
    std::uint64_t attachments = 0;
    std::uint32_t resets = 0;
    bool operator==(const Run&) const = default;
  };
  Run run();  // with the turn

  base::Turn<> turn_;  // to use what follows; attaching looks at files
  IfaceLink link_;
  IfaceLink world_;
  Run run_of_newest_;
  Say say_;
  std::size_t values_;  // of a command
  bool is_driving_ = false;
  bool refused_ = false;
  std::atomic<std::uint64_t> arrivals_{0};
  std::atomic<bool> in_simulated_time_{true};  // until the first onExecute says what the context is
};

// Stops a robot for which no velocity comes any more. The context's thread only.
class CommandWatch {
 public:
  // True once when nothing has come for `timeout_s` of simulated time and the robot was being driven; it is stopped then.
  bool expired(CommandingClient& commanding_client, std::int64_t now_ns, double timeout_s);

 private:
  std::uint64_t seen_arrivals_ = 0;
  std::int64_t seen_ns_ = 0;
};

}  // namespace iface

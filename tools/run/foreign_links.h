// Samples between third-party components of a run. They pass no port of this runtime, so this subscribes to each such OutPort, as a
// recorder does: for the hash log, which has them like samples of other OutPorts, and to detect nondeterminism. Values that differ in each
// run and are not data are left out: the stamp of the sender's own clock (if the first member of the type is an RTC::Time, it counts as 0),
// and the bytes that align members.
//
// A sample belongs to the simulated time in which it comes: its sender waits for the listener, and in lock step time waits for the sender.
// One thread at a time; samples come on the ORB's threads, and end() returns after the last one.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/guarded.h"
#include "base/hash_log.h"
#include "corba/transport/shape.h"
#include "run/foreign_processes.h"
#include "shm/client.h"
#include "system/profile/rts_profile.h"
#include "system/session.h"
#include "system/tap.h"

namespace tools {

class ForeignLinks {
 public:
  // `log`: where the part of the hash log goes; empty: nowhere. To be called once, while time stands still. What cannot be listened to is
  // named, for the user: it is no reason to end a run.
  Result<std::vector<std::string>> listen(CORBA::ORB_ptr orb, const Session& session, const SavedSystem& system,
                                          const ForeignProcesses& foreign, const std::string& simulator, const std::string& log);
  // Samples that came while no phase ran. One line for each port, with the time.
  std::vector<std::string> nondeterministic_events();
  // Listens no more. An error when not all of the log could be written. Peers that hang cost a second each.
  Result<void> end();

 private:
  struct Port {
    std::string name;  // "Alien:out"
    corba::Shape shape;
    bool has_stamp = false;
    std::uint32_t key = 0;
    // In the turn of samples:
    std::uint64_t samples = 0;                                // in this tick
    std::uint64_t hash = 0;                                   // of these
    std::string value;                                        // of the last one
    std::optional<std::chrono::nanoseconds> between_ticks{};  // the first that came so
  };
  Result<void> listen_on(CORBA::ORB_ptr orb, const Session& session, const ForeignProcesses& foreign, const SavedTarget& target);
  void take(Port& port, std::span<const unsigned char> payload, bool is_little_endian);
  void write();

  base::Turn<> turn_;  // of samples, one after the other, with what follows
  std::optional<shm::Iface> simulation_;
  std::optional<base::HashLogWriter> log_;
  std::uint32_t resets_ = 0;
  std::chrono::nanoseconds time_{0};  // of the samples that are not in the log yet
  std::deque<Port> ports_;            // stay where they are
  std::vector<std::unique_ptr<Tap>> taps_;
};

}  // namespace tools

// Finds ports whose process has exited, even if no sample is sent to them, so that their connections are removed. A thread calls one port
// of each other process from time to time, without a lock, and sleeps while there is no connection to another process. A hanging process
// has not exited. Any thread.
//
// It asks every corba.peer_check_interval seconds (2; 0: never). Connections of processes that exited are removed, with their listeners;
// a process that only hangs keeps its connections until a call to it exceeds its timeout. Profiles of ports are answered without calls to
// the other ends.
//
// States of a process:
//   unknown -> met        it has answered, or has not, but accepts connections
//   met -> hangs          a request exceeded its timeout (1 s). It is still asked in each round, after all others, for only 0.1 s (0.3 s
//                         on other machines), because the kernel rejects at once for a process that has exited
//   met, hangs -> gone    it has rejected twice; its connections are removed
//   hangs -> met          it has answered within the short time
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "corba/ports/loss_handler.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

// Works as long as it lives; one at a time.
class PeerWatch {
 public:
  explicit PeerWatch(std::chrono::milliseconds interval);
  // Waits for the call in progress, at most the second that one may take.
  ~PeerWatch();
  PeerWatch(const PeerWatch&) = delete;
  PeerWatch& operator=(const PeerWatch&) = delete;

 private:
  std::chrono::milliseconds interval_;
  std::thread thread_;
};

// The ports of a connection that are in other processes than `self` are looked after from now on; `loss` hears of it when one is dead.
// Nothing happens while there is no PeerWatch.
void watch_peers(const std::string& connector_id, const RTC::PortServiceList& ports, RTC::PortService_ptr self,
                 const std::shared_ptr<LossHandler>& loss);
void forget_peers(const std::string& connector_id, const LossHandler& loss);

// Where the process of an object listens, "127.0.0.1:43210"; the whole reference if it names no such place. Throws CORBA::SystemException
// for a reference that is none.
std::string process_address(CORBA::Object_ptr object);
// Of this host, by such an address.
bool is_on_loopback(std::string_view address);

}  // namespace corba

// A port of our own at the end of a connection: reads what an OutPort of another process sends, or writes to an InPort. Any thread.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

#include "system/component_view.h"

namespace tools {

// Whether it is a tap's, of this program or another one: no part of a system.
bool is_tap(const ConnectorView& connector);

class Tap {
 public:
  // Called from the ORB's threads, one call at a time, with the payload and its byte order. Keep it short: the writer waits.
  using OnData = std::function<void(std::span<const unsigned char> payload, bool little_endian)>;

  // Connects to `port` with a push connection (corba_cdr, flush). The port's direction decides which way data flows.
  static Result<std::unique_ptr<Tap>> connect(CORBA::ORB_ptr orb, const PortView& port, const Properties& extra, OnData on_data);
  // Disconnects.
  ~Tap();

  // Only for taps on an InPort.
  Result<void> put(std::span<const unsigned char> payload);

 private:
  class Port;
  class Receiver;
  Tap();
  RTC::PortService_var peer_;
  std::string id_;
  std::unique_ptr<Port, void (*)(Port*)> port_;
};

}  // namespace tools

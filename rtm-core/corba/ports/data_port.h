// The connections of a data port, of either side: the interface of the engines for the facade. Any thread; one reader at a time.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "corba/transport/event_data.h"
#include "corba/transport/transport.h"
#include "core/connector_settings.h"
#include "core/port_status.h"
#include "rtm/idl/RTCStub.h"

namespace base {
class Clock;
}

namespace corba {

// What a port knows about a connection before it exists.
struct ConnectionPlan {
  std::string id;
  std::string name;
  std::string port;  // whose connection it is, with the name of its component
  rt::ConnectorSettings settings;
  std::shared_ptr<ConnectorEvents> events;
  std::shared_ptr<Codec> codec;              // null: CDR
  std::shared_ptr<Carrier> carrier;          // of foreign interfaces
  bool peer_says_when_empty = false;         // the OutPort of a pull connection does not hand out old samples again
  std::shared_ptr<const base::Clock> clock;  // of the port's component, for time stamps; null: the calling thread's

  // The time by the component's clock; of a call that a component makes, by the clock of the context that runs it.
  std::chrono::nanoseconds port_time() const;
  std::chrono::nanoseconds caller_time() const;
  // Of the component's clock.
  std::uint64_t epoch() const;
  std::uint64_t phase_counter() const;
};

// What waits in a connection to be read or sent. Any thread.
class Waiting {
 public:
  virtual ~Waiting() = default;
  virtual std::size_t unread() const = 0;
  virtual void drop_unread() = 0;
};

class DataPort {
 public:
  struct Connected {
    std::shared_ptr<ConnectorEvents> events;  // of the connection's plan
    std::shared_ptr<Waiting> waiting;
  };

  virtual ~DataPort() = default;

  virtual const TypeOps& ops() const = 0;
  // Makes a connection and adds the keys by which the other port finds it.
  virtual rt::Refusal provide(ConnectionPlan plan, RTC::ConnectorProfile& profile) = 0;
  // Makes a connection to the other port, which the profile names.
  virtual rt::Refusal consume(ConnectionPlan plan, const RTC::ConnectorProfile& profile) = 0;
  // Undoes either. False if there is no such connection.
  virtual bool close(const std::string& id) = 0;
  // In the order in which they were made.
  virtual std::vector<Connected> connected() const = 0;
  virtual std::size_t count() const = 0;
  // Of the last read or write, in that order.
  virtual std::vector<rt::PortStatus> statuses() const = 0;

  // InPorts. Something unread is there (on the connections of that name). Asks the peers of pull connections. `lost`: ids of connections
  // whose peer is gone.
  virtual bool has_new(const std::string& name, std::vector<std::string>& lost) = 0;
  // Waits until something unread has come over a push connection, at most `most`; true if so.
  virtual bool wait_new(std::chrono::nanoseconds most) = 0;
  // Decodes the next sample into `value`; ok, or why not. `value` changes only if ok.
  virtual rt::PortStatus read(const std::string& name, void* value, std::vector<std::string>& lost) = 0;

  // OutPorts. False if there is no connection or one has failed.
  virtual bool write(const void* value) = 0;
  // Nobody is told of a loss any more.
  virtual void stop_telling() = 0;
};

std::unique_ptr<DataPort> make_in_port(const TypeOps& ops);
// `lost`: called with the id of a connection whose peer is gone, on any thread, until stop_telling() or the end of the port.
std::unique_ptr<DataPort> make_out_port(const TypeOps& ops, std::function<void(const std::string& id)> lost);

}  // namespace corba

// The two ends of every transport of data ports. Implementations: any thread; closing or destroying one does not wait for the peer.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <memory>
#include <string>

#include "corba/transport/payload.h"
#include "core/connector_settings.h"
#include "core/port_status.h"
#include "core/sample.h"
#include "rtm/idl/RTCStub.h"

namespace corba {

// Takes samples to the peer's InPort.
class Sender {
 public:
  virtual ~Sender() = default;
  // ok, error (this sample cannot be sent), send_full, send_timeout, connection_lost, unknown_error.
  virtual rt::PortStatus send(Payload& payload) = 0;
};

// Asks the peer's OutPort for samples.
class Fetcher {
 public:
  virtual ~Fetcher() = default;
  // ok, error, buffer_empty, recv_timeout, connection_lost, unknown_error.
  virtual rt::PortStatus fetch(rt::Sample& sample) = 0;
};

// Where a transport delivers what has come.
class Receiver {
 public:
  virtual ~Receiver() = default;
  // ok, error, buffer_full, buffer_timeout.
  virtual rt::PortStatus receive(rt::Sample sample) = 0;
  virtual rt::BlockPool& pool() = 0;
};

// Where a transport gets what the peer asks for.
class Source {
 public:
  virtual ~Source() = default;
  // ok, error, buffer_empty, buffer_timeout.
  virtual rt::PortStatus give(rt::Sample& sample) = 0;
};

// An object that peers call; they cannot any more once it is destroyed.
class Provider {
 public:
  virtual ~Provider() = default;
  // Borrowed.
  virtual CORBA::Object_ptr reference() const = 0;
  // The reference with the type of its interface.
  virtual CORBA::Any as_any() const = 0;
};

// A transport of an author, for one connection. Called without a lock; nothing throws, what fails is in the log.
class Carrier {
 public:
  virtual ~Carrier() = default;
  // The end that reaches the peer by what the profile says; nullptr when it cannot be made.
  virtual std::unique_ptr<Sender> make_sender(const RTC::ConnectorProfile& profile) = 0;
  virtual std::unique_ptr<Fetcher> make_fetcher(const RTC::ConnectorProfile& profile) = 0;
  // The end that the peer reaches: there as long as the result lives. May add to the profile what the peer must know. nullptr as above.
  virtual std::shared_ptr<void> serve(std::weak_ptr<Receiver> receiver, RTC::ConnectorProfile& profile) = 0;
  virtual std::shared_ptr<void> serve(std::weak_ptr<Source> source, RTC::ConnectorProfile& profile) = 0;
};

// What all calls of one connection share.
struct Line {
  rt::ByteOrder order = rt::ByteOrder::little;
  std::chrono::milliseconds call_timeout{10000};
  std::size_t shared_memory_size = std::size_t{2} << 20;
  std::string port = "data port";  // whose it is, and what it is called, for messages
  std::string connection{};
  std::string connector_id{};
};

// The ORB of this process.
CORBA::ORB_var orb();

// What the log says of a connection over which nothing more comes, before the reason.
inline constexpr std::string_view lost_mark = ": connection lost: ";

// What an exception of a call says about the connection; logs it.
rt::PortStatus status_of(const CORBA::SystemException& problem, const Line& line);
// Whether the connection was lost because the peer has answered with an exception, so that it would do so again; forgets it.
bool take_refusal(const std::string& connector_id);

// nullptr if the object is nil, unreachable or of another interface.
std::unique_ptr<Sender> make_cdr_sender(rt::Interface interface, CORBA::Object_ptr in_port, const Line& line);
std::unique_ptr<Fetcher> make_cdr_fetcher(rt::Interface interface, CORBA::Object_ptr out_port, const Line& line);
std::unique_ptr<Provider> make_cdr_in_provider(rt::Interface interface, std::shared_ptr<Receiver> receiver, const Line& line);
std::unique_ptr<Provider> make_cdr_out_provider(rt::Interface interface, std::shared_ptr<Source> source, const Line& line);

std::unique_ptr<Sender> make_shared_memory_sender(CORBA::Object_ptr in_port, const Line& line);
std::unique_ptr<Fetcher> make_shared_memory_fetcher(CORBA::Object_ptr out_port, const Line& line);
std::unique_ptr<Provider> make_shared_memory_in_provider(std::shared_ptr<Receiver> receiver, const Line& line);
std::unique_ptr<Provider> make_shared_memory_out_provider(std::shared_ptr<Source> source, const Line& line);

}  // namespace corba

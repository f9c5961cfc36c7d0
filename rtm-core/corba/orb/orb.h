// The ORB as a value: made with settings, gone with its destructor. One per process at a time (omniORB's rule). Any thread after start.
// Listens on the loopback interface unless told otherwise, on tcp and on a unix socket in a private folder; both are published, and guarded
// (corba/orb/guarded_transport.h).
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "corba/orb/guarded_transport.h"
#include "corba/orb/tls.h"

namespace corba {

class PeerWatch;

struct OrbSettings {
  // Where to listen: "HOST:PORT", ":PORT" (loopback), "HOST", "all" (every interface), "unix" or an omniORB end point "giop:...". Empty:
  // any free port on loopback. An empty list is the same as one empty string. An end point without a host is one of every interface when
  // everybody may call.
  std::vector<std::string> endpoints{};
  bool ipv4 = true;  // which families "all" stands for
  bool ipv6 = false;
  std::vector<std::string> further_addresses{};           // host:port, published beside the end points: where a router passes calls on
  bool unix_socket = true;                                // a further end point for processes of this host
  std::chrono::milliseconds call_timeout{10'000};         // of every call to another process; 0: none
  std::chrono::milliseconds peer_check_interval{2000};    // between looks for dead ports at the other ends of connections; 0: none
  std::size_t max_message_size = std::size_t{128} << 20;  // [byte], of samples of data ports and of answers to our own calls
  std::size_t max_request_size = std::size_t{2} << 20;    // [byte], of all other calls that come in
  // Who may call. Nothing: everybody when an end point is not on the loopback interface, else the own account only.
  std::optional<OpenTo> open_to{};
  TlsSettings tls{};                     // further end points for other hosts, and how to call theirs
  std::vector<std::string> arguments{};  // further -ORB... arguments; they win over the settings above
};

class Orb {
 public:
  // Fails with one line when an end point cannot be used or an argument is not understood. Requests are not served before activate().
  static base::Result<std::unique_ptr<Orb>> start(const OrbSettings& settings = {});
  // Shuts the ORB down: waits for requests in progress, then destroys it and removes the unix socket.
  ~Orb();
  Orb(const Orb&) = delete;
  Orb& operator=(const Orb&) = delete;

  void activate();

  // Of the unix socket; it goes with this object. Empty if there is none.
  std::string folder() const;
  // Where other hosts reach this ORB: host:port, of the references that it makes.
  std::vector<std::string> addresses() const;

  // Borrowed.
  CORBA::ORB_ptr orb() const { return orb_.in(); }
  PortableServer::POA_ptr root_poa() const { return root_poa_.in(); }
  PortableServer::POAManager_ptr poa_manager() const { return poa_manager_.in(); }

  // Makes the object answer under `corbaloc:iiop:<host>:<port>/<key>` too, by sending callers on to it. An existing key is replaced.
  void publish(const std::string& key, CORBA::Object_ptr object);
  void withdraw(const std::string& key);

 private:
  class PrivateFolder;
  Orb();
  CORBA::ORB_var orb_;
  PortableServer::POA_var root_poa_;
  PortableServer::POA_var ins_poa_;
  PortableServer::POAManager_var poa_manager_;
  std::unique_ptr<PrivateFolder> folder_;
  std::unique_ptr<PeerWatch> watch_;
};

// The object that has been published under the key of this reference; nil when the key is none of this process. A new reference.
CORBA::Object_ptr published_object(CORBA::Object_ptr reference);

// Every call through this reference (and copies made of it later) ends with CORBA::TIMEOUT or TRANSIENT after that time.
void set_call_timeout(CORBA::Object_ptr object, std::chrono::milliseconds timeout);

// An exception of a remote call in one line: "TRANSIENT (connect failed)".
std::string to_text(const CORBA::Exception& exception);

}  // namespace corba

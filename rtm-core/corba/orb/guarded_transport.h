// Access control of the ORB: every end point is one of omniORB's own, guarded by this transport. It checks the account of a caller, passes
// received data through a GiopGate, and closes silent connections. An end point "giop:guarded:tcp:HOST:PORT" is "giop:tcp:HOST:PORT" with a
// guard, and is published as that. Any thread.
#pragma once

#include <string>

#include "corba/orb/giop_gate.h"

namespace corba {

// Who may call.
enum class OpenTo {
  account,  // processes of the own account, and root
  host,     // every account of this machine
  network,  // everybody who reaches an end point
};

struct AccessSettings {
  OpenTo open_to = OpenTo::account;
  bool has_tls = false;  // there are end points of TLS: who comes in there is known by a certificate (corba/orb/tls.h), not by an account
  GiopLimits limits{};
};

// Takes effect for connections that come from now on. Also raises the number of files that this process may open to what it is allowed.
void set_access(const AccessSettings& settings);

// True if callers other than the own account are accepted: by corba.open_to or by TLS.
bool accepts_other_accounts();

// The end point with a guard before it; others than giop:tcp:, giop:unix: and giop:ssl: as they are.
std::string guarded(const std::string& endpoint);
// The end point that guarded() was given.
std::string unguarded(const std::string& endpoint);

// To be called once there is an ORB.
void remember_callers();

// Where the request comes from that runs on this thread: "giop:tcp:127.0.0.1:40000 (account 1000)". "this process" on a thread that has
// answered none.
std::string caller();
// True if this thread has answered a request.
bool has_caller();

}  // namespace corba

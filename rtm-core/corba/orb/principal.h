// The principal of a call. A call from another account or host can cause further calls of this process: of a manager to its slaves, of a
// port to the next one, of a context to a member. The further call carries the principal (call_context.h), and a process rejects calls on
// behalf of a principal that it would reject itself. The same holds for later calls, on any thread, through a reference that an untrusted
// caller sent: its object can forward the call, or have more addresses than the one that replied first. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <cstdint>
#include <optional>

namespace corba {

enum class Principal : std::uint32_t {
  own,          // this account, root, or no caller: a thread that executes no request
  host,         // another account of this machine
  network,      // another host
  certificate,  // another host with a certificate (corba/orb/tls.h)
};

// The principal of the request that this thread executes.
Principal principal();

// While this object exists, calls of this thread are on behalf of `principal`. For threads that continue the work of a request.
class OnBehalfOf {
 public:
  explicit OnBehalfOf(Principal principal);
  ~OnBehalfOf();
  OnBehalfOf(const OnBehalfOf&) = delete;
  OnBehalfOf& operator=(const OnBehalfOf&) = delete;

 private:
  const Principal before_;
};

// True if a reference that came with a request may be stored for later calls. Call it for every stored reference. A reference of an
// untrusted caller must respond within `timeout`. It is then registered with its principal; a process registers at most a million. Nil may
// be stored.
bool may_keep(CORBA::Object_ptr object, std::chrono::milliseconds timeout = std::chrono::seconds(2));

// The principal of the untrusted caller that sent this reference; `own` for all other references.
Principal sender_of(CORBA::Object_ptr object);

// OnBehalfOf the untrusted caller that sent this reference, if there is one. For calls to references that its object returns.
class OnBehalfOfSender {
 public:
  explicit OnBehalfOfSender(CORBA::Object_ptr object);

 private:
  std::optional<OnBehalfOf> principal_;
};

// For the transport: sets the principal of the request that this thread executes; makes calls carry it.
void set_principal(Principal principal);
void pass_on_principal();

}  // namespace corba

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

enum class Asker : std::uint32_t {
  own,          // this account, root, or nobody: a thread that carries out no request
  host,         // another account of this machine
  network,      // another host
  certificate,  // another host with a certificate (corba/orb/tls.h)
};

// Who sent the request that this thread carries out.
Asker asker();

// The thread works for somebody else, for as long as this lives: for threads that finish what a request has begun.
class ForAsker {
 public:
  explicit ForAsker(Asker asker);
  ~ForAsker();
  ForAsker(const ForAsker&) = delete;
  ForAsker& operator=(const ForAsker&) = delete;

 private:
  const Asker before_;
};

// Whether a reference that came with a request may be kept, to be called later: all that are, are asked for here. Those of strangers must
// answer them in time; those that do are remembered, and a process remembers a million. Nil may be kept.
bool may_keep(CORBA::Object_ptr object, std::chrono::milliseconds timeout = std::chrono::seconds(2));

// The stranger who gave this reference; `own` for all others.
Asker giver_of(CORBA::Object_ptr object);

// The thread works for who gave this reference, when that was a stranger: where what its object answers is called in turn.
class ForGiver {
 public:
  explicit ForGiver(CORBA::Object_ptr object);

 private:
  std::optional<ForAsker> asker_;
};

// For the transport: a thread carries out a request, of whom; and calls that say it.
void set_asker(Asker asker);
void pass_on_asker();

}  // namespace corba

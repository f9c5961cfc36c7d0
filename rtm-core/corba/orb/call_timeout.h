// Timeouts of calls to other ports, and the lock rule of all remote calls. Any thread.
#pragma once

#include <omniORB4/CORBA.h>

#include <chrono>
#include <cstddef>

namespace corba {

// The longest that a call to another port, or one sample on its way to one, may take unless the connection says otherwise
// (dataport.call_timeout). Default 10 s, as in OpenRTM 2.x.
void set_port_call_timeout(std::chrono::milliseconds timeout);
std::chrono::milliseconds port_call_timeout();

// Every later call of this reference ends after `timeout`, with CORBA::TIMEOUT or TRANSIENT if the other side hangs. Nil is ignored.
void limit_calls(CORBA::Object_ptr object, std::chrono::milliseconds timeout);

// From now on every call to another process expects that its thread holds no data (base/guarded.h; asserted in builds without NDEBUG).
// Once per process, when there is an ORB. Calls to objects of this process are not remote; limit_calls() expects the same for them.
void expect_no_data_held_at_calls();

// The other side has taken the whole time-out: it hangs, or the way there does.
bool is_time_out(const CORBA::Exception& problem);

// One deadline for calls that are made one after the other to peers that may all hang: three times the timeout of one. Any thread.
class ChainDeadline {
 public:
  explicit ChainDeadline(std::chrono::milliseconds timeout_of_one);
  bool is_over() const { return left() <= std::chrono::milliseconds::zero(); }
  std::chrono::milliseconds left() const;
  // Later calls of this reference end with the deadline, or with the timeout of one if that is earlier; at once when it is over.
  void limit(CORBA::Object_ptr object) const;

 private:
  std::chrono::milliseconds timeout_of_one_;
  std::chrono::steady_clock::time_point end_;
};

// The time-out of a call that leads through `left` of the `all` members of a chain, each of which waits for the next one: whoever comes
// later gives up earlier, and the whole chain takes at most the timeout of one.
std::chrono::milliseconds chain_timeout(std::chrono::milliseconds timeout_of_one, std::size_t left, std::size_t all);

}  // namespace corba
